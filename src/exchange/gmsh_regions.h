// The regions of a model in a Gmsh file (C. Geuzaine, J.-F. Remacle, Gmsh Reference Manual, "Gmsh
// file formats"; the section is the same in versions 2.2 and 4.1).
//
// A region is a field of the nodes, 1 in the region and 0 elsewhere, which Gmsh shows and which
// other readers skip or take as point data. A physical group would need point elements beside the
// tetrahedra, and MuJoCo reads files of a single block of elements only.
#ifndef LACUNA_EXCHANGE_GMSH_REGIONS_H_
#define LACUNA_EXCHANGE_GMSH_REGIONS_H_

#include <string>

#include "exchange/portable_model.h"

namespace lacuna {

// One section $NodeData for each region, with its name in the recording, to be put after the mesh
// of the model. Nodes are numbered from 1.
std::string GmshRegions(const PortableModel& model);

}  // namespace lacuna

#endif  // LACUNA_EXCHANGE_GMSH_REGIONS_H_
