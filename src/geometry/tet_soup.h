// Tetrahedra as a file lists them, before they are known to make a mesh.
#ifndef LACUNA_GEOMETRY_TET_SOUP_H_
#define LACUNA_GEOMETRY_TET_SOUP_H_

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <span>
#include <vector>

#include "geometry/mesh_io.h"

namespace lacuna {

struct TetSoup {
  std::vector<Eigen::Vector3d> nodes;
  std::vector<std::array<int, 10>> tets;  // the first `size` entries count; nodes in VTK's order
  std::vector<int> sizes;                 // 4 or 10
  std::vector<int> lines;                 // where each tetrahedron stands in the file

  void Add(std::span<const int> tet, int line);
};

// Checks, turns and renumbers as ReadTetMesh promises; `file` is for messages.
TetMeshFile FinishTetMesh(const TetSoup& soup, const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_TET_SOUP_H_
