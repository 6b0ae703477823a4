// Reading of JSON files.
#ifndef LACUNA_CORE_JSON_FILE_H_
#define LACUNA_CORE_JSON_FILE_H_

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "core/error.h"
#include "core/text_file.h"

namespace lacuna {

// What `read` makes of the content of a JSON file; the content itself where no `read` is given.
// `Json` is nlohmann::json or ordered_json. Throws InputError, which names the file, when it cannot
// be read, is not JSON, or has another structure than `read` expects (an exception of nlohmann's
// that `read` throws). `what` is what the file should be, with its article ("a diagnosis"): in the
// last two cases the message then says that the file is not that.
template <typename Json = nlohmann::json, typename Read = std::identity>
auto ReadJsonFile(const std::filesystem::path& file, const Read& read = {},
                  const std::string& what = "") {
  const std::string text = ReadWholeFile(file);
  try {
    return read(Json::parse(text));
  } catch (const nlohmann::json::parse_error& problem) {
    throw InputError({file.string()},
                     "is not " + (what.empty() ? "JSON" : what) + ": " + problem.what());
  } catch (const nlohmann::json::exception& problem) {
    throw InputError({file.string()},
                     (what.empty() ? "" : "is not " + what + ": ") + problem.what());
  }
}

}  // namespace lacuna

#endif  // LACUNA_CORE_JSON_FILE_H_
