// Tetrahedra as a file lists them, before it is known whether they form a valid mesh.
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
  std::vector<Eigen::Vector3d> nodes;     // positions in the file's length unit
  std::vector<std::array<int, 10>> tets;  // node indices in VTK's order; the first sizes[e] count
  std::vector<int> sizes;                 // nodes per tetrahedron: 4 or 10
  std::vector<int> lines;                 // the line of each tetrahedron in the file

  // Appends a tetrahedron of 4 or 10 nodes.
  void Add(std::span<const int> tet, int line);
};

// Checks the tetrahedra, removes repetitions and unused nodes, and reorients tetrahedra of negative
// volume, as described for ReadTetMesh. Throws InputError with `file` and line for an invalid mesh.
TetMeshFile FinishTetMesh(TetSoup soup, const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_TET_SOUP_H_
