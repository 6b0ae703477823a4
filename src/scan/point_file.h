// Reads and writes files with point clouds: PLY, PCD and text tables such as XYZ and CSV.
#ifndef LACUNA_SCAN_POINT_FILE_H_
#define LACUNA_SCAN_POINT_FILE_H_

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/point_cloud.h"

namespace lacuna {

// The columns of a text table that contain a point: names in the header, or numbers counted from 1.
// When they are left empty, the header must name x, y, z (and may name nx, ny, nz), or the table
// must have exactly three columns, or six of which the last three are unit vectors.
struct PointColumns {
  std::array<std::string, 3> position;
  std::array<std::string, 3> normal;
};

// The points of `file` in its own length unit, row by row, including rows with NaN. The extension
// decides on the format: .ply and .pcd (text or binary, float or double, with or without normals);
// everything else is a text table (delimited_table.h). Throws InputError naming the file when it is
// absent, truncated or malformed, or when it is unclear which columns are the coordinates.
// Doubts about the first line of a table are appended to `notes`, if it is given.
PointCloud ReadPointFile(const std::filesystem::path& file, const PointColumns& columns,
                         std::vector<std::string>* notes = nullptr);

// Writes a binary little-endian PLY of doubles, with normals if the cloud has them. Atomic. Throws
// InputError when the file cannot be written.
void WritePointFile(const std::filesystem::path& file, const PointCloud& cloud);

}  // namespace lacuna

#endif  // LACUNA_SCAN_POINT_FILE_H_
