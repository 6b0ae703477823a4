// Reading of OBJ, STL and OFF files: vertices, and polygons as lists of vertices.
//
// The readers accept what the programs that write these formats write. They throw InputError with
// the file, the line where there is one, and the fault; numbers that are not finite are faults.
#ifndef LACUNA_GEOMETRY_POLYGON_SOUP_H_
#define LACUNA_GEOMETRY_POLYGON_SOUP_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace lacuna {

struct PolygonSoup {
  std::vector<Eigen::Vector3d> points;        // in the file's length unit
  std::vector<std::vector<size_t>> polygons;  // vertices from 0; not yet known to exist
  std::vector<std::string> notes;             // what was left out, one sentence each
};

// Wavefront OBJ. Words are separated by any blanks; corners are v, v/vt, v//vn or v/vt/vn; negative
// numbers count back from the last vertex above the face; a line ending with \ continues. Lines
// other than v and f are skipped.
PolygonSoup ReadObj(const std::filesystem::path& file);

// STL as text, in upper or lower case, or binary. A file is binary if its length is the one that
// follows from the number of triangles in bytes 80 to 83, even if it begins with "solid". Each
// corner is a vertex of its own.
PolygonSoup ReadStl(const std::filesystem::path& file);

// OFF and its variants with colours (C), normals (N) or texture coordinates (ST), as text, and OFF
// without variants as "OFF BINARY", with 32-bit big-endian numbers. Comments begin with #. The
// counts may be on the line of the keyword, which may be missing, and on several lines; that of the
// edges may be missing. What follows the coordinates of a vertex or the corners of a face on its
// line is skipped; lines after the last face are refused.
PolygonSoup ReadOff(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_POLYGON_SOUP_H_
