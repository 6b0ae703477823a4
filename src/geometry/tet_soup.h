// Tetrahedra as a file lists them, before it is known whether they form a valid mesh.
#ifndef LACUNA_GEOMETRY_TET_SOUP_H_
#define LACUNA_GEOMETRY_TET_SOUP_H_

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "geometry/mesh_io.h"

namespace lacuna {

struct TetSoup {
  std::vector<Eigen::Vector3d> nodes;     // positions in the file's length unit
  std::vector<std::array<int, 10>> tets;  // node indices in VTK's order; the first sizes[e] count
  std::vector<int> sizes;                 // nodes per tetrahedron: 4 or 10
  std::vector<int> lines;                 // the line of each tetrahedron in the file

  // Volume elements that are not read, whose part of the body would be missing: how many there are,
  // what the first of them is ("a prism") and its line.
  long long others = 0;
  std::string first_other;
  int line_of_other = 0;

  // Appends a tetrahedron of 4 or 10 nodes.
  void Add(std::span<const int> tet, int line);
  // Counts volume elements of another kind.
  void AddOther(const std::string& what, int line, long long count = 1);
};

// Checks the tetrahedra, removes repetitions and unused nodes, and reorients tetrahedra of negative
// volume, as described for ReadTetMesh. Throws InputError with `file` and line for an invalid mesh,
// one with other volume elements, and one whose midside nodes lie on each other's edges.
TetMeshFile FinishTetMesh(TetSoup soup, const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_TET_SOUP_H_
