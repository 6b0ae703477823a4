// The header of a PLY file.
//
// The libraries that read the bodies of PLY files trust their headers: a property that belongs to
// no element, a negative count or an unknown type makes them read outside their buffers. A header
// that is read here is known to be sound.
#ifndef LACUNA_GEOMETRY_PLY_HEADER_H_
#define LACUNA_GEOMETRY_PLY_HEADER_H_

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lacuna {

struct PlyProperty {
  std::string name;
  bool is_list = false;
  bool is_floating = false;    // float or double
  size_t bytes = 0;            // of a value in a binary file
  size_t bytes_of_length = 0;  // of the length of a list
  bool has_signed_length = false;
};

struct PlyElement {
  std::string name;
  size_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  bool is_text = false;
  bool is_big_endian = false;
  std::vector<PlyElement> elements;
  size_t body = 0;  // position of the first byte after the header

  // Null: there is no such element.
  const PlyElement* Find(std::string_view element) const;
};
// Null: there is no such property.
const PlyProperty* FindProperty(const PlyElement& element, std::string_view name);

// `content`: the whole file. Throws InputError with the file and the line for a header that is
// incomplete, holds an unknown word, has a name that is not printable ASCII, announces the same
// element twice, or announces more values than the file has bytes.
PlyHeader ReadPlyHeader(const std::filesystem::path& file, std::string_view content);

// Throws InputError for a body that ends too early, for a list with a negative length, and for a
// word of a text that is not a finite number, or not a whole one where its type is. Other readers
// make room for a list before they read it, and take whatever they find after the end of a file
// for its length.
void CheckPlyBody(const std::filesystem::path& file, std::string_view content,
                  const PlyHeader& header);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_PLY_HEADER_H_
