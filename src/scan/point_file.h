// Reads and writes files with point clouds: PLY, PCD and text tables such as XYZ and CSV.
#ifndef LACUNA_SCAN_POINT_FILE_H_
#define LACUNA_SCAN_POINT_FILE_H_

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/point_cloud.h"
#include "scan/delimited_table.h"

namespace lacuna {

// The columns of a text table that contain a point: names in the header, or numbers counted from 1.
// When they are left empty, the header must name x, y, z (and may name nx, ny, nz), or the table
// must have exactly three columns, or six of which the last three are unit vectors. Displacements
// are added where the header is that of a table of image correlation (displacement_table.h).
struct PointColumns {
  std::array<std::string, 3> position;
  std::array<std::string, 3> normal;
  std::array<std::string, 3> displacement;  // added to the position
  std::string sigma;                        // negative or NaN: the point was not measured
  std::string status;                       // of the correlation (DisplacementColumns::status)
  std::string id;                           // identifies a point in all frames
  // Whether positions that are named beside displacements are those of the deformed state.
  bool positions_are_deformed = false;
};

// What a table of image correlation says about its points.
struct CorrelationTable {
  bool is_read = false;     // false: the file is none
  std::vector<double> ids;  // of each row; empty where the table gives none
  std::string length_unit;  // of any table with names of columns; empty where they give none
  Eigen::VectorXd sigma;    // of each row, in any unit; empty where the table gives none
  Eigen::Matrix3Xd points;  // 3 × rows, in the file's unit; NaN where a point failed
  // 3 × rows, as the columns have them, and whether the former include the latter.
  Eigen::Matrix3Xd places, displacements;
  bool places_are_deformed = false;
};

// The points of `file` in its own length unit, row by row, including rows with NaN. The extension
// decides on the format: .ply and .pcd (text or binary, float or double, with or without normals);
// everything else is a text table (delimited_table.h). Throws InputError naming the file when it is
// absent, truncated or malformed, or when it is unclear which columns are the coordinates.
// What was taken for what, where a table leaves doubt, is appended to `notes`, if it is given.
// `correlation`, if given, is filled where the file is a table of image correlation.
PointCloud ReadPointFile(const std::filesystem::path& file, const PointColumns& columns,
                         std::vector<std::string>* notes = nullptr,
                         CorrelationTable* correlation = nullptr);

// The points of a text table that has been read already.
PointCloud PointsOfTable(DelimitedTable table, const PointColumns& columns,
                         std::vector<std::string>* notes = nullptr,
                         CorrelationTable* correlation = nullptr);

// What the same file says as a table of image correlation. is_read is false also for a file that
// cannot be read, which ReadPointFile reports.
CorrelationTable ReadCorrelationTable(const std::filesystem::path& file,
                                      const PointColumns& columns);

// Writes a binary little-endian PLY of doubles, with normals if the cloud has them. Atomic. Throws
// InputError when the file cannot be written.
void WritePointFile(const std::filesystem::path& file, const PointCloud& cloud);

}  // namespace lacuna

#endif  // LACUNA_SCAN_POINT_FILE_H_
