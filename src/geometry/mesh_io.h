// Triangle and tetrahedral meshes from files and to files.
#ifndef LACUNA_GEOMETRY_MESH_IO_H_
#define LACUNA_GEOMETRY_MESH_IO_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/tet_mesh.h"
#include "geometry/tri_mesh.h"

namespace lacuna {

// Both readers tell the format by the extension, keep the file's own length unit, and throw
// InputError with file, line where there is one, and fault: an absent or truncated file, another
// version of the format, numbers that are not finite, indices out of range, no elements at all.
// What they had to change stands in `notes`, a sentence each.

struct TriMeshFile {
  TriMesh mesh;
  std::vector<std::string> notes;
};

// .ply, .obj, .stl and .off, text or binary where the format knows both. Polygons are cut into
// triangles; the vertices of an STL file are merged where they are equal, bit by bit. The surface
// may be of any topology: see CheckSurface.
TriMeshFile ReadTriMesh(const std::filesystem::path& file);

struct TetMeshFile {
  TetMesh mesh;
  Eigen::VectorXi node_in_file;  // place of each node among the nodes of the file, from 0
  std::vector<std::string> notes;
};

// Gmsh .msh 2.2 (text; tetrahedra of order 1 or 2, other elements are passed over), TetGen .node
// and .ele (either is named, both are read; order 1), MEDIT .mesh (text, order 1), .tet (lines "v x
// y z" and "t i j k l" from 0), and .txt (numbers of nodes and tetrahedra, nodes, tetrahedra from
// 0). Tetrahedra that turn the wrong way are turned over, nodes that no tetrahedron uses are
// dropped, each with a note. Tetrahedra without volume, with repeated nodes, that overlap across a
// face or meet by three at one are refused.
TetMeshFile ReadTetMesh(const std::filesystem::path& file);

// Binary PLY of doubles; Gmsh .msh 2.2 text that gives back the same doubles. Written atomically;
// throws InputError when the file cannot be written.
void WriteTriMesh(const std::filesystem::path& ply, const TriMesh& mesh);
void WriteTetMesh(const std::filesystem::path& msh, const TetMesh& mesh);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_MESH_IO_H_
