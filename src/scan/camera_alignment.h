// Refines the poses of synchronised cameras relative to one another by the surface that they
// observe together.
//
// The cloud of each camera is registered to the clouds of all others by ICP (PCL), which minimises
// the distance of mutually nearest points p, q along the sum of their normals,
//   Σ ((p − q)·(n_p + n_q))²
// (symmetric ICP, Rusinkiewicz 2019). Unlike the distance to a single tangent plane, this does not
// push the views of a curved surface apart.
#ifndef LACUNA_SCAN_CAMERA_ALIGNMENT_H_
#define LACUNA_SCAN_CAMERA_ALIGNMENT_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace lacuna {

struct AlignmentOptions {
  // m; pairs further apart are ignored. Larger: tolerates larger errors of the poses, but may pair
  // points of different surfaces.
  double max_distance = 0.01;
  double max_angle = 0.8;  // rad; pairs whose normals differ more are ignored, which keeps the two
                           // sides of thin parts apart
  int neighbours = 16;     // neighbours of a normal; larger: less noise, but rounder edges
  int sweeps = 4;          // how often each camera but the first is registered to all others
  int iterations = 40;     // ICP iterations in each registration
  // A direction of motion (of six; rotations are multiplied by the size of the overlap) is left
  // unchanged when the mean squared distance of the pairs grows by less than this factor times the
  // square of the motion. Larger: corrects sliding motions less, and drifts less along directions
  // that the surface does not determine.
  double min_stiffness = 0.003;
  int min_pairs = 100;  // with fewer pairs the overlap is too small to be reliable
};

// What the refinement did to the pose of one camera.
struct CameraCorrection {
  bool applied = false;
  std::string message = "not run";
  // The new world_from_camera is correction · (the old one).
  Eigen::Isometry3d correction = Eigen::Isometry3d::Identity();
  double angle = 0;         // rad, angle of the correction
  double translation = 0;   // m, how far the centroid of the camera's cloud moves
  int free_directions = 0;  // number of the six directions that are left unchanged
  double rms_before = -1;   // m, root mean square distance of the pairs along their normals; −1:
  double rms_after = -1;    // there are no pairs
};

// Registers the cloud of each camera (3 × n, m, world frame) to all others; the first camera keeps
// its pose. `positions` (3 × cameras, m, world frame) orient the normals. A registration is
// rejected when it does not converge, has too few pairs or moves the cloud further than
// max_distance. A camera without any accepted registration keeps its pose, and its message says
// why; nothing is thrown.
std::vector<CameraCorrection> AlignCameras(const std::vector<Eigen::Matrix3Xd>& clouds,
                                           const Eigen::Matrix3Xd& positions,
                                           const AlignmentOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SCAN_CAMERA_ALIGNMENT_H_
