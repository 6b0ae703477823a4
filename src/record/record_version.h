// Which version of Lacuna has written a record, compared with this one.
#ifndef LACUNA_RECORD_RECORD_VERSION_H_
#define LACUNA_RECORD_RECORD_VERSION_H_

namespace lacuna {

enum class RecordVersion { kEarlier, kThis, kLater };

// Within a sentence.
inline const char* RecordVersionText(RecordVersion version) {
  switch (version) {
    case RecordVersion::kEarlier:
      return "an earlier version of Lacuna";
    case RecordVersion::kThis:
      return "this version of Lacuna";
    case RecordVersion::kLater:
      return "a later version of Lacuna";
  }
  return "";
}

}  // namespace lacuna

#endif  // LACUNA_RECORD_RECORD_VERSION_H_
