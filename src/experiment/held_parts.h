// Which nodes the held parts of an object hold.
#ifndef LACUNA_EXPERIMENT_HELD_PARTS_H_
#define LACUNA_EXPERIMENT_HELD_PARTS_H_

#include <Eigen/Core>
#include <vector>

#include "geometry/axis_set.h"
#include "geometry/tet_mesh.h"
#include "scan/region.h"

namespace lacuna {

struct HeldPart {
  Region region;
  AxisSet axes = AxisSet::All();  // along which it is held
  bool moves = false;
};

// The nodes of the mesh in each part, ascending. A part that is held along some axes only
// does without the nodes that another part holds along all axes, as where a plane of symmetry meets
// a clamp; two such parts at rest may share nodes. Throws InputError with the names of the parts
// where one holds no node, two others hold a node along the same axis, or no component is free.
std::vector<Eigen::VectorXi> NodesOfParts(const std::vector<HeldPart>& parts, const TetMesh& mesh);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_HELD_PARTS_H_
