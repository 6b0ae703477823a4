// Recognises JSON files that another version of Lacuna has written.
#ifndef LACUNA_RECORD_SCHEMA_VERSION_H_
#define LACUNA_RECORD_SCHEMA_VERSION_H_

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "core/error.h"
#include "record/record_version.h"

namespace lacuna {

// `version` is the "schema_version" that this version of Lacuna writes. A record without such a
// number is an earlier one.
inline RecordVersion VersionOf(const nlohmann::json& record, int version) {
  const auto found = record.is_object() ? record.find("schema_version") : record.end();
  if (found == record.end() || !found->is_number_integer()) return RecordVersion::kEarlier;
  const int64_t number = *found;
  if (number == version) return RecordVersion::kThis;
  return number < version ? RecordVersion::kEarlier : RecordVersion::kLater;
}

// Throws InputError where "schema_version" is not `version`; the message names the command that
// rewrites the file. Throws nlohmann::json::exception where the key is absent.
inline void RequireSchemaVersion(const nlohmann::json& value, int version,
                                 const std::string& command) {
  const int found = value.at("schema_version");
  if (found == version) return;
  throw InputError("is in format " + std::to_string(found) + " of " +
                   RecordVersionText(VersionOf(value, version)) + "; this one reads format " +
                   std::to_string(version) + ": run `" + command + "` again");
}

}  // namespace lacuna

#endif  // LACUNA_RECORD_SCHEMA_VERSION_H_
