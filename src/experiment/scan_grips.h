// How a gripped part of an object moves, as the scans of its surface tell it.
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
  std::string name;        // for messages
  std::vector<int> nodes;  // of the mesh
  double reach = 0;        // m; points farther than this from the grip's surface are not its own
  // The first of the frames is the undeformed shape: motions are taken relative to it, and errors
  // of the shape cancel.
  bool rests_at_first = false;
};

// The rigid motions that carry the grip's part of the boundary from rest onto each of these frames:
// point-to-plane fits (Chen & Medioni 1992), each begun where the last ended. Scanned points
// nearest to the rim of that part belong to its neighbours and are left out. Throws InputError
// where the part is no surface, where a frame shows too little of it, and where its shape does not
// tell all six components of a motion (a flat or round part can slide unseen).
std::vector<Eigen::Isometry3d> FollowGrip(const ScanFrames& scans, const std::vector<int>& frames,
                                          const BoundarySurface& boundary, const ScannedGrip& grip);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_SCAN_GRIPS_H_
