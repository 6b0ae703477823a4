// Names of files and folders from names that people give.
#ifndef LACUNA_CORE_FILE_NAME_H_
#define LACUNA_CORE_FILE_NAME_H_

#include <algorithm>
#include <cctype>
#include <string>

namespace lacuna {

// Whether a file or folder of this name lies where it is created and is visible there: the name is
// not empty, does not begin with a dot, as ".." does, and has no path separator of any system and
// no control character.
inline bool IsFileName(const std::string& name) {
  const auto is_refused = [](unsigned char c) {
    return c == '/' || c == '\\' || c < 0x20 || c == 0x7f;
  };
  return !name.empty() && name.front() != '.' && std::none_of(name.begin(), name.end(), is_refused);
}

// `name` with every character other than letters, digits, "-", "+" and "." replaced by "_", and a
// dot at its beginning, too; "_" for an empty name. The result is a file name (IsFileName).
inline std::string FileNameFor(const std::string& name) {
  std::string file = name.empty() ? "_" : name;
  for (char& letter : file)
    if (std::isalnum(static_cast<unsigned char>(letter)) == 0 && letter != '-' && letter != '+' &&
        letter != '.')
      letter = '_';
  if (file.front() == '.') file.front() = '_';
  return file;
}

}  // namespace lacuna

#endif  // LACUNA_CORE_FILE_NAME_H_
