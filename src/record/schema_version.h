// Refuses JSON files that another version of Lacuna has written.
#ifndef LACUNA_RECORD_SCHEMA_VERSION_H_
#define LACUNA_RECORD_SCHEMA_VERSION_H_

#include <nlohmann/json.hpp>
#include <string>

#include "core/error.h"

namespace lacuna {

// Throws InputError where "schema_version" is not `version`; the message names the command that
// rewrites the file. Throws nlohmann::json::exception where the key is absent.
inline void RequireSchemaVersion(const nlohmann::json& value, int version,
                                 const std::string& command) {
  const int found = value.at("schema_version");
  if (found == version) return;
  throw InputError("is in format " + std::to_string(found) +
                   " of another version of Lacuna; this " + "one reads format " +
                   std::to_string(version) + ": run `" + command + "` again");
}

}  // namespace lacuna

#endif  // LACUNA_RECORD_SCHEMA_VERSION_H_
