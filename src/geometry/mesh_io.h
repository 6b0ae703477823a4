// Reading and writing of triangle meshes (tri_mesh_io.cc) and tetrahedral meshes (tet_mesh_io.cc).
//
// The readers choose the format by the extension and keep the file's length unit. They throw
// InputError with the file, the line if there is one, and the fault: a missing or truncated file,
// an unsupported version of the format, numbers that are not finite, indices out of range, or no
// elements at all. Changes that they had to make are listed in `notes`, one sentence each.
#ifndef LACUNA_GEOMETRY_MESH_IO_H_
#define LACUNA_GEOMETRY_MESH_IO_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/tet_mesh.h"
#include "geometry/tri_mesh.h"

namespace lacuna {

// The readers refuse coordinates beyond this, in the file's length unit: products of three of them
// must not overflow.
inline constexpr double kFarthestCoordinate = 1e100;

struct TriMeshFile {
  TriMesh mesh;
  Eigen::VectorXi vertex_in_file;     // index of each vertex among those of the file, ascending
  Eigen::Index vertices_in_file = 0;  // STL: the corners of all triangles
  bool is_mended = false;  // whether MendSurface changed more than a sound file of its format needs
  std::vector<std::string> notes;
};

// Reads .ply, .obj, .stl and .off, in text or binary form where the format has both;
// polygon_soup.h says which variants. Polygons, concave ones too, are cut into triangles
// (polygon_triangles.h), those with more than 10 000 corners are refused. MendSurface
// (mended_surface.h) merges vertices at the same place, drops repeated and degenerate triangles and
// unused vertices, and turns triangles that are seen from inside, each with a note. The surface may
// still have any topology; CheckSurface examines it.
TriMeshFile ReadTriMesh(const std::filesystem::path& file);

struct TetMeshFile {
  TetMesh mesh;
  Eigen::VectorXi node_in_file;  // index of each node among the nodes of the file, from 0
  std::vector<std::string> notes;
};

// Reads the following formats:
//   .msh          Gmsh 2.2 and 4.1, text; tetrahedra of order 1 or 2, and nothing flat
//   .node, .ele   TetGen, order 1; either file is named and both are read
//   .mesh         MEDIT, text, order 1
//   .tet          lines "v x y z" and "t i j k l", indices from 0
//   .txt          the numbers of nodes and tetrahedra, the nodes, the tetrahedra (indices from 0)
// Tetrahedra with negative volume are reoriented, repetitions of a tetrahedron with the same list
// of nodes (Gmsh 2.2 writes one for each physical group) and unused nodes are dropped, each with a
// note. Points, lines and faces are skipped; volume elements that are no tetrahedra are refused,
// because a part of the body would be missing. Tetrahedra that have no volume or a repeated node,
// have their midside nodes on each other's edges (as in the order of another format), overlap
// across a face, or share one face among three are refused, and so are lines after those that a
// count announces.
TetMeshFile ReadTetMesh(const std::filesystem::path& file);
// The files that it reads for this name: two of TetGen, one of any other format.
std::vector<std::filesystem::path> FilesOfTetMesh(const std::filesystem::path& file);

// Write a binary PLY file of doubles and a Gmsh .msh 2.2 text file, respectively. Reading them back
// gives the same doubles. Both write atomically and throw InputError if that fails.
void WriteTriMesh(const std::filesystem::path& ply, const TriMesh& mesh);
void WriteTetMesh(const std::filesystem::path& msh, const TetMesh& mesh);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_MESH_IO_H_
