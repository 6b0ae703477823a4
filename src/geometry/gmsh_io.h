// Gmsh's .msh files, text, of versions 2.2 and 4.1 (C. Geuzaine, J.-F. Remacle, Gmsh Reference
// Manual, "Gmsh file formats"). Quadratic tetrahedra have the midpoint of (2,3) before that of
// (1,3) there. mesh_io.h has the functions for all formats.
#ifndef LACUNA_GEOMETRY_GMSH_IO_H_
#define LACUNA_GEOMETRY_GMSH_IO_H_

#include <filesystem>
#include <string>

#include "geometry/tet_mesh.h"
#include "geometry/tet_soup.h"

namespace lacuna {

// Reads tetrahedra of order 1 or 2, and counts other volume elements; points, lines, faces and
// other sections are skipped. Throws InputError with file and line.
TetSoup ReadGmsh(const std::filesystem::path& file);

enum class GmshVersion { k22, k41 };

// The text of a file with the mesh as one volume, nodes and elements numbered from 1. Reading it
// back gives the same doubles.
std::string GmshText(const TetMesh& mesh, GmshVersion version);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_GMSH_IO_H_
