// Reading of a whole file into memory.
#ifndef LACUNA_CORE_TEXT_FILE_H_
#define LACUNA_CORE_TEXT_FILE_H_

#include <filesystem>
#include <string>

namespace lacuna {

// All bytes of `file`. Throws InputError naming it if it does not exist, is a folder or cannot be
// read completely.
std::string ReadWholeFile(const std::filesystem::path& file);

// The content of a text file in UTF-8, with lines that end with "\n" or "\r\n". A byte order mark
// is not part of it, bytes that are not UTF-8 are taken for Latin-1, and a single "\r" ends a line
// where the file has no "\n". Throws InputError, which names what the file is, for UTF-16, UTF-32,
// archives and other files that are no text.
std::string ReadTextFile(const std::filesystem::path& file);

// `text` where it is UTF-8; otherwise its bytes are taken for Latin-1 and converted.
std::string InUtf8(std::string text);

}  // namespace lacuna

#endif  // LACUNA_CORE_TEXT_FILE_H_
