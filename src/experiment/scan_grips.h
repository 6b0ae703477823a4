// The motion of a gripped part of an object, estimated from scans of its surface.
#ifndef LACUNA_EXPERIMENT_SCAN_GRIPS_H_
#define LACUNA_EXPERIMENT_SCAN_GRIPS_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "experiment/scan_frames.h"
#include "geometry/tet_mesh.h"

namespace lacuna {

struct ScannedGrip {
  std::string name;        // name of the grip, for messages
  std::vector<int> nodes;  // gripped nodes of the mesh
  double reach = 0;        // m; points farther than this from the grip's surface are not used
  // Whether the first frame shows the undeformed shape. Motions are then relative to it, so that
  // errors of the shape cancel.
  bool rests_at_first = false;
};

// The rigid motions that carry the grip's part of the boundary from rest onto each of these frames,
// by point-to-plane fits (Chen & Medioni 1992), each of which starts from the result of the
// previous one. Scanned points nearest to the rim of that part are left out, because they may
// belong to its neighbours. Throws InputError where the part has no surface, where a frame shows
// too little of it, and where its shape does not determine all six components of a motion (a flat
// or round part can slide unnoticed).
std::vector<Eigen::Isometry3d> FollowGrip(const ScanFrames& scans, const std::vector<int>& frames,
                                          const BoundarySurface& boundary, const ScannedGrip& grip);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_SCAN_GRIPS_H_
