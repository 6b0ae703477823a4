// Content hashes, which identify inputs and results.
//
// The hash is XXH3 with 128 bits (Y. Collet, xxHash 0.8). It is the same on every machine, and
// accidental collisions are negligible; it does not protect against deliberate forgery.
#ifndef LACUNA_CORE_HASH_H_
#define LACUNA_CORE_HASH_H_

#include <filesystem>
#include <string>
#include <string_view>

namespace lacuna {

// The hash of `bytes` as 32 hexadecimal digits.
std::string HashBytes(std::string_view bytes);

// The hash of a file's content. Throws InputError naming the file if it cannot be read.
std::string HashFile(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_CORE_HASH_H_
