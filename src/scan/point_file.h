// Point clouds from files: PLY, PCD, XYZ and text tables.
#ifndef LACUNA_SCAN_POINT_FILE_H_
#define LACUNA_SCAN_POINT_FILE_H_

#include <array>
#include <filesystem>
#include <string>

#include "geometry/point_cloud.h"

namespace lacuna {

// The columns of a text table that hold a point: names of the header, or numbers counted from 1.
// Left empty, the columns are x, y, z of the header, or the only three (or six) there are.
struct PointColumns {
  std::array<std::string, 3> position;
  std::array<std::string, 3> normal;
};

// The points of `file` in its own length unit, row by row, rows with NaN included. The format is
// told by the extension: .ply and .pcd (text or binary, float or double, with or without normals),
// everything else is a text table (delimited_table.h). Throws InputError naming the file when it
// is absent, truncated, malformed, or its columns are not clear.
PointCloud ReadPointFile(const std::filesystem::path& file, const PointColumns& columns);

// Binary little-endian PLY of doubles, with normals if the cloud has them; written atomically.
void WritePointFile(const std::filesystem::path& file, const PointCloud& cloud);

}  // namespace lacuna

#endif  // LACUNA_SCAN_POINT_FILE_H_
