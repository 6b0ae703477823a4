// Reading of a whole file into memory.
#ifndef LACUNA_CORE_TEXT_FILE_H_
#define LACUNA_CORE_TEXT_FILE_H_

#include <filesystem>
#include <string>

namespace lacuna {

// All bytes of `file`. Throws InputError naming it if it does not exist, is a folder or cannot be
// read completely.
std::string ReadWholeFile(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_CORE_TEXT_FILE_H_
