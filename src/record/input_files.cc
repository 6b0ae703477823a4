#include "record/input_files.h"

#include "core/error.h"
#include "core/hash.h"

namespace lacuna {
namespace {

InputError ChangedWhileRead(const FileState& file) {
  return InputError({file.file.string()},
                    "has changed while this command was reading it, so that its result would mix "
                    "old and new data; run the command again");
}

}  // namespace

void InputFiles::Add(const std::string& name, const FileState& file) {
  const std::string hash = HashFile(file.file);
  if (StateOf(file.file) != file) throw ChangedWhileRead(file);
  files_.push_back({file, hash});
  const auto [entry, is_new] = hashes_.try_emplace(name, hash);
  if (!is_new) entry->second = HashBytes(entry->second + hash);
}

void InputFiles::RequireUnchanged() const {
  for (const InputFile& input : files_)
    if (StateOf(input.state.file) != input.state && HashFile(input.state.file) != input.hash)
      throw ChangedWhileRead(input.state);
}

}  // namespace lacuna
