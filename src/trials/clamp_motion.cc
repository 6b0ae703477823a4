#include "trials/clamp_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/rotation.h"

namespace lacuna {
namespace {

struct ClampProgram {
  Eigen::Vector3d rotation, shake;  // rad, m
  double frequency;                 // Hz
};
const ClampProgram kPrograms[] = {{{1.4, 0, 0}, {0, 1.2e-3, 1.6e-3}, 7},
                                  {{0, -0.7, 0}, {0, 1.6e-3, -1.2e-3}, 11}};
constexpr double kProgramBegins = 0.25, kRotationTime = 0.2;  // s

// Rises from 0 to 1 for t in [0, 1], with zero velocity and acceleration at both ends.
double SmoothStep(double t) {
  const double s = std::clamp(t, 0.0, 1.0);
  return s * s * s * (10 + s * (6 * s - 15));
}

}  // namespace

ClampMotion ClampMotionAt(int recording, double time) {
  const ClampProgram& program = kPrograms[recording];
  const double since = time - kProgramBegins, risen = SmoothStep(since / kRotationTime);
  return {risen * program.rotation,
          risen * std::sin(2 * std::numbers::pi * program.frequency * since) * program.shake};
}

Eigen::Isometry3d ClampMotion::Place() const {
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  place.translate(shift);
  place.rotate(RotationBy(rotation));
  return place;
}

}  // namespace lacuna
