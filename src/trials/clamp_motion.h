// The motion of the clamp in a sealed case. It is part of the recording, so the model knows it.
//
// The bar first swings freely. Then the clamp rotates, so that gravity acts in another direction
// relative to the bar and effects fixed to the object separate from effects fixed in space; and it
// shakes, so that the second bending mode is excited and the bar moves with and against the
// surroundings.
#ifndef LACUNA_TRIALS_CLAMP_MOTION_H_
#define LACUNA_TRIALS_CLAMP_MOTION_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace lacuna {

// x = exp([rotation]×) X + shift.
struct ClampMotion {
  Eigen::Vector3d rotation;  // rotation vector about the origin, rad
  Eigen::Vector3d shift;     // m

  Eigen::Isometry3d Place() const;
};

// The motion in recording 0 or 1 of a case at a time, s; zero until the clamp starts to move.
ClampMotion ClampMotionAt(int recording, double time);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_CLAMP_MOTION_H_
