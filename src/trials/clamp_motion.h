// How the clamp of a sealed case moves, which its recording tells.
#ifndef LACUNA_TRIALS_CLAMP_MOTION_H_
#define LACUNA_TRIALS_CLAMP_MOTION_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace lacuna {

// Once the bar has swung freely the clamp turns, so that weight acts another way and what is fixed
// to the object parts from what is fixed in space; and it shakes, so that the second mode takes
// part and the bar moves with and against what stands still.
struct ClampMotion {
  Eigen::Vector3d turn, shift;  // rotation vector about the origin, rad; m

  Eigen::Isometry3d Place() const;
};

// Of a case's recording 0 or 1 at a time, s.
ClampMotion ClampMotionAt(int recording, double time);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_CLAMP_MOTION_H_
