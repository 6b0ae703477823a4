// Content hashes, by which inputs and results are recognised.
//
// XXH3, 128 bits (Y. Collet, xxHash 0.8): the same on every machine and far beyond chance
// collisions, but no protection against somebody who forges a file.
#ifndef LACUNA_CORE_HASH_H_
#define LACUNA_CORE_HASH_H_

#include <filesystem>
#include <string>
#include <string_view>

namespace lacuna {

// 32 hexadecimal digits.
std::string HashBytes(std::string_view bytes);

// The hash of a file's content. Throws InputError naming the file when it cannot be read.
std::string HashFile(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_CORE_HASH_H_
