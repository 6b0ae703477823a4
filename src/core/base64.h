// Bytes as text: base64 (RFC 4648, section 4), with padding and without line breaks.
#ifndef LACUNA_CORE_BASE64_H_
#define LACUNA_CORE_BASE64_H_

#include <string>
#include <string_view>

namespace lacuna {

std::string EncodeBase64(std::string_view bytes);

// The reverse. Throws InputError where `text` is not the base64 of any bytes.
std::string DecodeBase64(std::string_view text);

}  // namespace lacuna

#endif  // LACUNA_CORE_BASE64_H_
