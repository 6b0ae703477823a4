// The files that a run reads, with the hashes under which its manifest lists them.
//
// A run takes up to hours. A file that is replaced or written to in that time would lead to a
// result from old and new data, stored under the hash of one of them. The state of each file is
// therefore noted before it is read, and its content, hashed in that state, is compared before a
// result is stored.
#ifndef LACUNA_RECORD_INPUT_FILES_H_
#define LACUNA_RECORD_INPUT_FILES_H_

#include <map>
#include <string>
#include <vector>

#include "core/file_state.h"

namespace lacuna {

class InputFiles {
 public:
  // Adds a file whose state was noted before anything was read of it. Files of one name share a
  // hash. Throws InputError naming the file if it cannot be read or is in another state now.
  void Add(const std::string& name, const FileState& file);

  // Throws InputError naming the first file whose content is not the one that was hashed. Only
  // files in another state are read again.
  void RequireUnchanged() const;

  const std::map<std::string, std::string>& hashes() const { return hashes_; }  // by name

 private:
  struct InputFile {
    FileState state;
    std::string hash;
  };
  std::vector<InputFile> files_;
  std::map<std::string, std::string> hashes_;
};

}  // namespace lacuna

#endif  // LACUNA_RECORD_INPUT_FILES_H_
