// The correspondences of scanned points to a model's surface.
#ifndef LACUNA_EXPERIMENT_SCAN_MATCHES_H_
#define LACUNA_EXPERIMENT_SCAN_MATCHES_H_

#include <Eigen/Core>
#include <vector>

#include "experiment/scan_frames.h"
#include "fem/body.h"
#include "geometry/face_points.h"
#include "geometry/surface_patches.h"

namespace lacuna {

// The correspondence of a scanned point p to a place x of the surface. Its error, m, is n · (x −
// p).
//
// In general n is the surface's outward normal at x. A point that lies beside a face, beyond the
// edge at which the surface ends or turns away, is displaced from the edge by more than noise in
// the plane of that face, which the face's normal does not show. Its n is the direction from the
// edge to the point, and it belongs to the patch behind the edge. So the outline of a face that is
// seen frontally contributes where the object lies within the plane of the face.
struct ScanMatch {
  int patch = -1;  // −1: none
  FacePoint place;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // n
  double error = 0;
  double depth = 0;  // m, of the scanned surface below the model's; the error is less by it
};

struct ScanMatches {
  std::vector<ScanMatch> matches;  // one for each scanned point
  double distance = 0;  // m, mean distance from the surface, each at most the object's size
};

// Matches `scan` with the surface of `body` at the node positions `nodes` (3 × n, m). Points
// farther away than `reach` (m) have no correspondence, nor have points whose normal deviates by
// more than 60° from that of the surface. `depth`: of the scanned surface below the model's, m.
ScanMatches MatchScan(const ScannedPoints& scan, const Body& body, const SurfacePatches& patches,
                      const Eigen::Ref<const Eigen::Matrix3Xd>& nodes, double reach, double depth);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_SCAN_MATCHES_H_
