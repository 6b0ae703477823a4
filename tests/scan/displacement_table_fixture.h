// A fixture for tests that read tables of image correlation, alone or as frames of a recording.
#ifndef LACUNA_TESTS_SCAN_DISPLACEMENT_TABLE_FIXTURE_H_
#define LACUNA_TESTS_SCAN_DISPLACEMENT_TABLE_FIXTURE_H_

#include <string>

#include "scan/delimited_table.h"
#include "scan/recording_fixture.h"

namespace lacuna {

class DisplacementTable : public RecordingTest {
 protected:
  DelimitedTable Table(const std::string& content) const {
    return ReadDelimitedTable(folder_.Write("table.txt", content));
  }
};

// The rows of the points `first` to `last` − 1 as a nodemap, displaced by `w` along z.
inline std::string Rows(int first, int last, double w) {
  std::string text = "ID;x_undef [mm];y_undef [mm];z_undef [mm];u [mm];v [mm];w [mm]\n";
  for (int i = first; i < last; ++i)
    text += std::to_string(i) + ";" + std::to_string(i * 10) + ";" + std::to_string(i * 7 % 11) +
            ";" + std::to_string(i * 5 % 3) + ";0;0;" + std::to_string(w) + "\n";
  return text;
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_SCAN_DISPLACEMENT_TABLE_FIXTURE_H_
