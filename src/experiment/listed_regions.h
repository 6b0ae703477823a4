// The regions that list nodes by their numbers in the reference file.
#ifndef LACUNA_EXPERIMENT_LISTED_REGIONS_H_
#define LACUNA_EXPERIMENT_LISTED_REGIONS_H_

#include <vector>

#include "experiment/model_reader.h"
#include "geometry/tet_mesh.h"
#include "scan/recording.h"
#include "scan/region.h"

namespace lacuna {

// Sets in those of the regions that list nodes to which nodes the numbers refer: the vertices of
// the file that is the reference shape of `recording`, or of its first frame if that is a tracked
// mesh. SelectNodes then adds the nodes that a mesh with `settings` has between them. Reads the
// file if a region lists nodes. Throws InputError with the file and the name of the region where a
// number is too large, or where the numbers are not those of the nodes of a mesh: a surface that is
// reconstructed or whose triangles are divided, an STL file, or tetrahedra beside unused nodes.
void NumberListedNodes(const Recording& recording, const MeshSettings& settings,
                       const std::vector<Region*>& regions);

// Replaces each list of nodes by that of all nodes of `mesh` in the region, for a recording whose
// reference file is this mesh.
void ListNodesOfMesh(const TetMesh& mesh, const std::vector<Region*>& regions);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_LISTED_REGIONS_H_
