// Names of files from names that people give.
#ifndef LACUNA_CORE_FILE_NAME_H_
#define LACUNA_CORE_FILE_NAME_H_

#include <cctype>
#include <string>

namespace lacuna {

// `name` with every character other than letters, digits, "-", "+" and "." replaced by "_".
inline std::string FileNameFor(const std::string& name) {
  std::string file = name;
  for (char& letter : file)
    if (std::isalnum(static_cast<unsigned char>(letter)) == 0 && letter != '-' && letter != '+' &&
        letter != '.')
      letter = '_';
  return file;
}

}  // namespace lacuna

#endif  // LACUNA_CORE_FILE_NAME_H_
