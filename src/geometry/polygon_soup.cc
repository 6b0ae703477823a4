#include "geometry/polygon_soup.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>

#include "core/error.h"
#include "core/letter_case.h"
#include "core/parsed_word.h"
#include "core/text_file.h"
#include "geometry/text_scanner.h"

namespace lacuna {
namespace {

// The vertex of a corner such as 7, 7/2, 7//3 or -1/2/3, as it stands there.
long long CornerNumber(std::string_view corner, const TextScanner& scanner) {
  const auto vertex = ParseWord<long long>(corner.substr(0, corner.find('/')));
  if (!vertex)
    scanner.Fail(fmt::format("got \"{}\"; expected a corner such as 7, 7/2 or 7//3", corner));
  return *vertex;
}

constexpr size_t kStlHeader = 84, kStlTriangle = 50;

size_t AnnouncedTriangles(const std::string& content) {
  static_assert(std::endian::native == std::endian::little);
  uint32_t count = 0;
  if (content.size() >= kStlHeader) std::memcpy(&count, content.data() + 80, sizeof(count));
  return count;
}

bool IsTextStl(const std::string& content) {
  const size_t begin = content.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (begin == std::string::npos || InLowerCase(content.substr(begin, 5)) != "solid") return false;
  return content.find('\0') == std::string::npos;
}

PolygonSoup ReadBinaryStl(const std::filesystem::path& file, const std::string& content) {
  const size_t count = AnnouncedTriangles(content);
  PolygonSoup soup;
  for (size_t t = 0; t < count; ++t) {
    std::array<float, 12> numbers;  // the normal, then the corners
    std::memcpy(numbers.data(), content.data() + kStlHeader + t * kStlTriangle, sizeof(numbers));
    std::vector<size_t> polygon;
    for (int corner = 1; corner <= 3; ++corner) {
      const Eigen::Vector3d point(numbers[3 * corner], numbers[3 * corner + 1],
                                  numbers[3 * corner + 2]);
      if (!point.allFinite()) {
        throw InputError({file.string()},
                         fmt::format("a corner of triangle {} of {} is not finite", t + 1, count));
      }
      polygon.push_back(soup.points.size());
      soup.points.push_back(point);
    }
    soup.polygons.push_back(std::move(polygon));
  }
  const size_t rest = content.size() - kStlHeader - count * kStlTriangle;
  if (rest > 0) soup.notes.push_back(fmt::format("skipped {} bytes after the triangles", rest));
  return soup;
}

PolygonSoup ReadTextStl(const std::filesystem::path& file) {
  PolygonSoup soup;
  TextScanner scanner(file);
  std::vector<size_t> polygon;
  bool is_open = false;
  while (scanner.NextLine()) {
    while (!scanner.AtLineEnd()) {
      const std::string word = InLowerCase(scanner.Word("a keyword"));
      // The rest of these lines is a name.
      if (word == "solid" || word == "endsolid") {
        is_open = word == "solid";
        break;
      }
      if (word == "vertex") {
        polygon.push_back(soup.points.size());
        soup.points.push_back(scanner.Point("a coordinate"));
      }
      if (word != "endloop") continue;
      if (polygon.size() < 3) {
        scanner.Fail(fmt::format("a facet ends after {} of 3 vertices", polygon.size()));
      }
      soup.polygons.push_back(std::move(polygon));
      polygon.clear();
    }
  }
  if (is_open || !polygon.empty()) {
    scanner.Fail(fmt::format("is truncated: it ends without endsolid after {} facets",
                             soup.polygons.size()));
  }
  return soup;
}

struct OffHeader {
  long long vertices = 0, faces = 0;
  bool is_at_vertex = false;  // the number of edges is missing: the first vertex is on this line
};

long long OffCount(std::string_view word, const char* what, const TextScanner& scanner) {
  const auto count = ParseWord<long long>(word);
  if (!count || *count < 0) scanner.Fail(fmt::format("got \"{}\"; expected {}", word, what));
  return *count;
}

OffHeader ReadOffHeader(TextScanner* scanner) {
  scanner->ExpectLine("OFF");
  std::string_view word = scanner->Word("OFF");
  const std::string lower = InLowerCase(word);
  if (const size_t at = lower.find("off"); at != std::string::npos) {
    const std::string_view variant = word.substr(0, at);
    if (variant == "n" || variant.find_first_not_of("STCNstcn") != std::string_view::npos) {
      scanner->Fail(
          fmt::format("{} is not read: its vertices do not have three coordinates", word));
    }
    // Some programs write the first count without a blank after the keyword.
    word.remove_prefix(at + 3);
    if (word.empty()) word = scanner->WordAnywhere("the number of vertices");
  } else if (std::isdigit(static_cast<unsigned char>(word[0])) == 0) {
    scanner->Fail(fmt::format("got \"{}\"; an OFF file begins with OFF", word));
  }
  OffHeader header;
  header.vertices = OffCount(word, "the number of vertices", *scanner);
  header.faces =
      OffCount(scanner->WordAnywhere("the number of faces"), "the number of faces", *scanner);
  // The number of edges is not used, and some programs do not write it. On a line of its own it is
  // the only number there.
  const bool has_own_line = scanner->AtLineEnd();
  if (has_own_line) scanner->ExpectLine("the number of edges");
  header.is_at_vertex = has_own_line && scanner->WordsLeft() > 1;
  if (!header.is_at_vertex)
    OffCount(scanner->Word("the number of edges"), "the number of edges", *scanner);
  return header;
}

// The numbers of a binary OFF file, which are big-endian.
class BinaryOff {
 public:
  BinaryOff(const std::filesystem::path& file, std::string_view rest) : file_(file), rest_(rest) {}

  uint32_t Bits(const char* what) {
    if (rest_.size() < 4)
      throw InputError({file_.string()}, fmt::format("is truncated: it ends before {}", what));
    uint32_t bits = 0;
    for (int k = 0; k < 4; ++k) bits = bits << 8 | static_cast<unsigned char>(rest_[k]);
    rest_.remove_prefix(4);
    return bits;
  }
  double Number(const char* what) {
    const double number = std::bit_cast<float>(Bits(what));
    if (!std::isfinite(number))
      throw InputError({file_.string()}, fmt::format("holds {} that is not finite", what));
    return number;
  }
  // A count of things that take at least four bytes each.
  uint32_t Count(const char* what) {
    const uint32_t count = Bits(what);
    if (count > rest_.size() / 4)
      throw InputError({file_.string()},
                       fmt::format("is truncated or malformed: {} is {}", what, count));
    return count;
  }
  size_t Left() const { return rest_.size(); }  // bytes

 private:
  const std::filesystem::path& file_;
  std::string_view rest_;
};

PolygonSoup ReadBinaryOff(const std::filesystem::path& file, std::string_view numbers) {
  BinaryOff body(file, numbers);
  PolygonSoup soup;
  const uint32_t vertices = body.Count("the number of vertices");
  const uint32_t faces = body.Count("the number of faces");
  body.Bits("the number of edges");
  for (uint32_t v = 0; v < vertices; ++v) {
    Eigen::Vector3d point;
    for (double& coordinate : point) coordinate = body.Number("a coordinate");
    soup.points.push_back(point);
  }
  for (uint32_t f = 0; f < faces; ++f) {
    std::vector<size_t> polygon(body.Count("the number of corners"));
    for (size_t& corner : polygon) {
      corner = body.Bits("a corner");
      if (corner >= vertices)
        throw InputError({file.string()},
                         fmt::format("face {} of {}: there is no vertex {}", f + 1, faces, corner));
    }
    soup.polygons.push_back(std::move(polygon));
    for (uint32_t k = body.Count("the number of colours"); k > 0; --k) body.Bits("a colour");
  }
  if (body.Left() > 0)
    throw InputError({file.string()}, fmt::format("{} bytes follow, but the number of faces is {}",
                                                  body.Left(), faces));
  return soup;
}

}  // namespace

PolygonSoup ReadObj(const std::filesystem::path& file) {
  PolygonSoup soup;
  TextScanner scanner(file, '#');
  std::vector<int> lines;
  while (scanner.NextLine()) {
    const std::string_view keyword = scanner.Word("a keyword");
    if (keyword == "v") soup.points.push_back(scanner.Point("a coordinate"));
    if (keyword != "f") continue;
    lines.push_back(scanner.Line());
    std::vector<size_t> polygon;
    while (!scanner.AtLineEnd()) {
      const std::string_view corner = scanner.Word("a corner");
      if (corner == "\\") {
        scanner.ExpectLine("the rest of a face");
        continue;
      }
      const long long number = CornerNumber(corner, scanner);
      const auto count = static_cast<long long>(soup.points.size());
      if (number == 0 || number < -count) {
        scanner.Fail(fmt::format("there is no vertex {}: {} stand above", number, count));
      }
      polygon.push_back(static_cast<size_t>(number > 0 ? number - 1 : count + number));
    }
    soup.polygons.push_back(std::move(polygon));
  }
  // A face may stand above its vertices.
  for (size_t f = 0; f < soup.polygons.size(); ++f) {
    for (const size_t vertex : soup.polygons[f]) {
      if (vertex < soup.points.size()) continue;
      throw InputError({file.string(), lines[f]},
                       fmt::format("there is no vertex {}: they count from 1 to {}", vertex + 1,
                                   soup.points.size()));
    }
  }
  return soup;
}

PolygonSoup ReadStl(const std::filesystem::path& file) {
  const std::string content = ReadWholeFile(file);
  const size_t count = AnnouncedTriangles(content);
  const size_t length = kStlHeader + kStlTriangle * count;
  if (content.size() == length) return ReadBinaryStl(file, content);
  if (IsTextStl(content)) return ReadTextStl(file);
  if (content.size() < kStlHeader) {
    throw InputError({file.string()},
                     "is not an STL file: it does not begin with \"solid\", and "
                     "is shorter than the header of a binary one");
  }
  if (content.size() < length) {
    throw InputError({file.string()},
                     fmt::format("is truncated, or not an STL file: it announces {} triangles and "
                                 "has room for {}",
                                 count, (content.size() - kStlHeader) / kStlTriangle));
  }
  return ReadBinaryStl(file, content);
}

PolygonSoup ReadOff(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string first_line;
  std::getline(stream, first_line);
  if (first_line.starts_with("OFF BINARY"))
    return ReadBinaryOff(file, std::string(std::istreambuf_iterator<char>(stream), {}));
  PolygonSoup soup;
  TextScanner scanner(file, '#');
  const OffHeader header = ReadOffHeader(&scanner);
  for (long long v = 0; v < header.vertices; ++v) {
    if (v > 0 || !header.is_at_vertex)
      scanner.ExpectLine(fmt::format("vertex {} of {}", v + 1, header.vertices));
    Eigen::Vector3d point;
    for (double& coordinate : point) {
      if (scanner.AtLineEnd()) scanner.ExpectLine("a coordinate");
      coordinate = scanner.Number("a coordinate");
    }
    soup.points.push_back(point);
  }
  for (long long f = 0; f < header.faces; ++f) {
    scanner.ExpectLine(fmt::format("face {} of {}", f + 1, header.faces));
    const long long corners =
        OffCount(scanner.Word("the number of corners"), "the number of corners", scanner);
    std::vector<size_t> polygon;
    for (long long k = 0; k < corners; ++k) {
      const long long vertex =
          OffCount(scanner.WordAnywhere("a corner"), "the number of a vertex", scanner);
      if (vertex >= header.vertices) {
        scanner.Fail(fmt::format("there is no vertex {}: they count from 0 to {}", vertex,
                                 header.vertices - 1));
      }
      polygon.push_back(static_cast<size_t>(vertex));
    }
    soup.polygons.push_back(std::move(polygon));
  }
  if (scanner.NextLine())
    scanner.Fail(fmt::format("a line follows, but the number of faces is {}", header.faces));
  return soup;
}

}  // namespace lacuna
