// The hash of a JSON value's content, by which a damaged line or file is recognised.
#ifndef LACUNA_RECORD_JSON_HASH_H_
#define LACUNA_RECORD_JSON_HASH_H_

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>

#include "core/hash.h"

namespace lacuna {

// The hash of the value without some entries, such as the hash itself and a wall time, which
// differs between two runs of the same command. `entries`: JSON pointers (RFC 6901), such as
// "/hash" and "/evaluation/seconds"; those that do not exist are passed over. `Json` is
// nlohmann::json or ordered_json.
template <typename Json>
std::string HashWithout(Json value, std::initializer_list<const char*> entries) {
  for (const char* entry : entries) {
    const typename Json::json_pointer pointer{std::string(entry)};
    if (value.contains(pointer)) value.at(pointer.parent_pointer()).erase(pointer.back());
  }
  return HashBytes(value.dump());
}

}  // namespace lacuna

#endif  // LACUNA_RECORD_JSON_HASH_H_
