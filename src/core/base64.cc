#include "core/base64.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/error.h"

namespace lacuna {
namespace {

constexpr std::string_view kDigits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

constexpr std::array<int, 256> DigitValues() {
  std::array<int, 256> values{};
  values.fill(-1);
  for (size_t k = 0; k < kDigits.size(); ++k)
    values[static_cast<unsigned char>(kDigits[k])] = static_cast<int>(k);
  return values;
}
constexpr std::array<int, 256> kValueOf = DigitValues();

}  // namespace

std::string EncodeBase64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t k = 0; k < bytes.size(); k += 3) {
    const size_t count = std::min<size_t>(3, bytes.size() - k);
    uint32_t group = 0;
    for (size_t i = 0; i < 3; ++i)
      group = group << 8 | (i < count ? static_cast<unsigned char>(bytes[k + i]) : 0U);
    for (size_t i = 0; i < 4; ++i) text += i <= count ? kDigits[group >> (6 * (3 - i)) & 63U] : '=';
  }
  return text;
}

std::string DecodeBase64(std::string_view text) {
  if (text.size() % 4 != 0) throw InputError("is not base64: its length is no multiple of 4");
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  for (size_t k = 0; k < text.size(); k += 4) {
    const bool is_last = k + 4 == text.size();
    size_t count = 4;
    while (is_last && count > 2 && text[k + count - 1] == '=') --count;
    uint32_t group = 0;
    for (size_t i = 0; i < 4; ++i) {
      const int value = i < count ? kValueOf[static_cast<unsigned char>(text[k + i])] : 0;
      if (value < 0) throw InputError("is not base64: it contains another character");
      group = group << 6 | static_cast<uint32_t>(value);
    }
    for (size_t i = 0; i + 1 < count; ++i)
      bytes += static_cast<char>(group >> (8 * (2 - i)) & 255U);
  }
  return bytes;
}

}  // namespace lacuna
