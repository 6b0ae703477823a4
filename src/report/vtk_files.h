// Files for ParaView: tetrahedra (.vtu), surfaces and points (.vtp), time series (.pvd).
//
// Files are written atomically as VTK XML with compressed, appended float64 data; lengths are in m.
// Throws InputError, which names the file, where it cannot be written.
#ifndef LACUNA_REPORT_VTK_FILES_H_
#define LACUNA_REPORT_VTK_FILES_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/point_cloud.h"
#include "geometry/tet_mesh.h"
#include "geometry/tri_mesh.h"

namespace lacuna {

// Values with a name that contains the unit: "displacement_m". One column per node or cell; one row
// is a scalar, three are a vector, nine a tensor (row by row).
struct Field {
  std::string name;
  Eigen::MatrixXd values;
};

struct FieldSet {
  std::vector<Field> nodes;
  std::vector<Field> cells;  // tetrahedra or triangles
};

// CHECKs that each field has one column for each node or cell and a name of its own, and that the
// elements' nodes exist.
void WriteVtu(const std::filesystem::path& file, const TetMesh& mesh, const FieldSet& fields);
void WriteVtp(const std::filesystem::path& file, const TriMesh& mesh, const FieldSet& fields);
// Each point becomes a vertex; normals, where there are any, become the field "normal".
void WriteVtp(const std::filesystem::path& file, const PointCloud& cloud,
              const std::vector<Field>& fields);

struct TimedFile {
  double time = 0;  // s, increasing
  std::filesystem::path file;
};

// Lists the files of a time series. They are named relative to the folder of `file`, so that the
// whole folder can be moved.
void WritePvd(const std::filesystem::path& file, const std::vector<TimedFile>& series);

}  // namespace lacuna

#endif  // LACUNA_REPORT_VTK_FILES_H_
