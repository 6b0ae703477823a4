// Compression of bytes in the gzip format (RFC 1952), which every browser decompresses.
#ifndef LACUNA_CORE_GZIP_H_
#define LACUNA_CORE_GZIP_H_

#include <string>
#include <string_view>

namespace lacuna {

// The compressed bytes. They contain neither a time nor a file name: the same bytes give the same
// result.
std::string Gzip(std::string_view bytes);

// The reverse. Throws InputError where `compressed` is damaged or incomplete.
std::string Gunzip(std::string_view compressed);

}  // namespace lacuna

#endif  // LACUNA_CORE_GZIP_H_
