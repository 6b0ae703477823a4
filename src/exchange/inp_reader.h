// Reads mesh, sets and material of an input file of Abaqus or CalculiX.
//
// Read are *NODE, *ELEMENT with TYPE=C3D4 or C3D10 and their variants such as C3D10MH (hybrid,
// modified, …), which become plain tetrahedra with a note, *NSET and *ELSET (also GENERATE and
// names of other sets; *NSET also with ELSET, the nodes of these elements), *MATERIAL with *ELASTIC
// and *DENSITY, and the ELSET and MATERIAL of *SOLID SECTION; *HEADING is skipped. The file is
// flat: node numbers are unique, as CalculiX requires. Every other keyword, elements of lines and
// surfaces included, is listed in `not_read`. No other file is opened: *INCLUDE and, where data
// would have to be read, INPUT=… are refused. Numbers stay in the file's own units, which an .inp
// file does not state.
#ifndef LACUNA_EXCHANGE_INP_READER_H_
#define LACUNA_EXCHANGE_INP_READER_H_

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "exchange/portable_model.h"

namespace lacuna {

struct ImportedMaterial {
  std::string name;
  std::optional<double> young_modulus, poisson_ratio, density;
  // Whether the modulus is that of the shortest times (MODULI=INSTANTANEOUS), which relaxes.
  bool is_instantaneous = false;
  // Tetrahedra that a *SOLID SECTION gives this material; 0 also where the file has no section.
  size_t element_count = 0;
};

struct ImportedModel {
  TetMesh mesh;  // nodes in the order of the file, unused ones dropped
  // Sets of the file that are not empty; the others are named in `notes`.
  std::vector<NamedNodes> node_sets;     // of nodes of `mesh`, ascending
  std::vector<NamedNodes> element_sets;  // of elements of `mesh`, ascending
  std::vector<ImportedMaterial> materials;
  std::vector<std::string> not_read;  // "line 812: *BOUNDARY"
  std::vector<std::string> notes;     // changes of the mesh and of the sets, one sentence each
};

// Throws InputError with file and line for a line that does not follow the format, numbers that are
// not finite, nodes or sets that do not exist, numbers that appear twice, sets of more than 30
// million entries in all or with a parameter that is not known, coordinates that are not Cartesian,
// an instance that is moved or turned, volume elements other than tetrahedra, an elasticity that is
// not isotropic or depends on temperature, or a mesh that ReadTetMesh would refuse (mesh_io.h).
ImportedModel ReadInp(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_EXCHANGE_INP_READER_H_
