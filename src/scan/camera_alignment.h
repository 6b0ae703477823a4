// Refines how synchronised cameras stand to one another, by the surface that they see in common.
#ifndef LACUNA_SCAN_CAMERA_ALIGNMENT_H_
#define LACUNA_SCAN_CAMERA_ALIGNMENT_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace lacuna {

struct AlignmentOptions {
  double max_distance = 0.01;  // m; pairs further apart do not count. Larger: bears larger errors
                               // of the poses, but pairs points that are not the same surface
  double max_angle = 0.8;      // rad between the normals of a pair; keeps thin sides apart
  int neighbours = 16;         // for the normals; larger: less noise, edges rounded more
  int sweeps = 4;              // each camera but the first is fitted to all others so often
  int iterations = 40;         // of ICP in each fit
  // Directions of motion (of six, rotations times the size of the overlap) along which the pairs'
  // mean squared distance grows by less than this times the motion squared are left as they are.
  // Larger: sliding is taken out less, and drifts less where the surface does not tell it.
  double min_stiffness = 0.003;
  int min_pairs = 100;  // below: the overlap is too small to be trusted
};

// What the refinement did to one camera's pose: new world_from_camera = correction · old one.
struct CameraCorrection {
  bool applied = false;
  std::string message = "not run";
  Eigen::Isometry3d correction = Eigen::Isometry3d::Identity();
  double angle = 0;         // of the correction, rad
  double translation = 0;   // of the camera's cloud: how far its centroid moves, m
  int free_directions = 0;  // of six, that the overlap does not pin down: left as given
  double rms_before = -1;   // distance of the pairs along their normals, m; −1: none
  double rms_after = -1;
};

// ICP (PCL) of each camera's cloud (3 × n, world frame, m) against all others; the first camera
// stands still. It minimises the distance of mutually nearest points along the sum of both normals
// (Rusinkiewicz 2019), which, unlike the distance to one plane, does not push the views of a curved
// surface apart. `positions` (3 × cameras) orient the normals. A fit that does not converge, has
// too few pairs or moves the cloud further than max_distance is not taken; a camera without any
// stays where it was and the message says why.
std::vector<CameraCorrection> AlignCameras(const std::vector<Eigen::Matrix3Xd>& clouds,
                                           const Eigen::Matrix3Xd& positions,
                                           const AlignmentOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SCAN_CAMERA_ALIGNMENT_H_
