#include "core/text_file.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "core/utf8.h"

namespace lacuna {
namespace {

using namespace std::string_view_literals;

constexpr const char* kSaveAsUtf8 = "; save it as UTF-8 (in Excel: \"CSV UTF-8\")";

// Why the bytes are not a text in an encoding of single bytes; empty where they are.
std::string ForeignEncoding(std::string_view bytes) {
  // UTF-32 is tested first, because its mark begins like that of UTF-16.
  constexpr std::array<std::pair<std::string_view, const char*>, 4> kMarks{
      {{"\xff\xfe\0\0"sv, "UTF-32 (little endian)"},
       {"\0\0\xfe\xff"sv, "UTF-32 (big endian)"},
       {"\xff\xfe"sv, "UTF-16 (little endian)"},
       {"\xfe\xff"sv, "UTF-16 (big endian)"}}};
  for (const auto& [mark, name] : kMarks) {
    if (bytes.starts_with(mark)) return std::string("is encoded as ") + name + kSaveAsUtf8;
  }
  if (bytes.starts_with("PK\x03\x04"sv))
    return "is a ZIP archive, such as an Excel workbook, and not a text; save it as CSV";
  if (bytes.starts_with("\xd0\xcf\x11\xe0"sv))
    return "is an old Excel workbook and not a text; save it as CSV";
  if (bytes.starts_with("\x1f\x8b"sv)) return "is compressed (gzip); unpack it";
  const std::string_view head = bytes.substr(0, 4096);
  std::array<size_t, 2> zeros{};
  for (size_t i = 0; i < head.size(); ++i) zeros[i % 2] += head[i] == '\0';
  // Texts of Latin letters in UTF-16 have a zero in every second byte.
  for (const size_t parity : {0u, 1u}) {
    if (zeros[1 - parity] == 0 && 4 * zeros[parity] > head.size()) {
      return std::string("is encoded as UTF-16 (") + (parity == 1 ? "little" : "big") + " endian)" +
             kSaveAsUtf8;
    }
  }
  if (zeros[0] + zeros[1] > 0) return "holds bytes of value 0: it is not a text";
  return "";
}

bool IsUtf8(std::string_view text) {
  for (size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    const int following = lead < 0x80 ? 0 : lead >= 0xf0 ? 3 : lead >= 0xe0 ? 2 : 1;
    if ((lead >= 0x80 && lead < 0xc2) || lead > 0xf4) return false;
    for (int k = 0; k < following; ++k, ++i) {
      if (i >= text.size() || !ContinuesCharacter(text[i])) return false;
    }
  }
  return true;
}

std::string Utf8FromLatin1(std::string_view text) {
  std::string converted;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      converted += c;
    } else {
      converted += static_cast<char>(0xc0 | byte >> 6);
      converted += static_cast<char>(0x80 | (byte & 0x3f));
    }
  }
  return converted;
}

}  // namespace

std::string ReadWholeFile(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file))
    throw InputError({file.string()}, "is a folder; expected a file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError({file.string()}, "cannot be read: no such file, or no permission");
  std::string content(std::istreambuf_iterator<char>(stream), {});
  if (stream.bad()) throw InputError({file.string()}, "cannot be read completely");
  return content;
}

std::string ReadTextFile(const std::filesystem::path& file) {
  std::string content = ReadWholeFile(file);
  if (content.starts_with("\xef\xbb\xbf")) content.erase(0, 3);
  if (const std::string problem = ForeignEncoding(content); !problem.empty())
    throw InputError({file.string()}, problem);
  content = InUtf8(std::move(content));
  if (content.find('\n') == std::string::npos)
    std::replace(content.begin(), content.end(), '\r', '\n');
  return content;
}

std::string InUtf8(std::string text) {
  return IsUtf8(text) ? std::move(text) : Utf8FromLatin1(text);
}

}  // namespace lacuna
