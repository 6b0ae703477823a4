// A file, read whole.
#ifndef LACUNA_CORE_TEXT_FILE_H_
#define LACUNA_CORE_TEXT_FILE_H_

#include <filesystem>
#include <string>

namespace lacuna {

// All bytes of a file. Throws InputError naming it when it is not there, is a folder or cannot be
// read to its end.
std::string ReadWholeFile(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_CORE_TEXT_FILE_H_
