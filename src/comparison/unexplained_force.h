// The body force that would have made a fitted model follow one recording.
#ifndef LACUNA_COMPARISON_UNEXPLAINED_FORCE_H_
#define LACUNA_COMPARISON_UNEXPLAINED_FORCE_H_

#include <Eigen/Core>

#include "prediction/smooth_force.h"
#include "record/unexplained_force_record.h"

namespace lacuna {

// The force over time, with one entry or column for each state of the motion that includes it.
// Vectors are in the model's frame; deviations are standard deviations of the components.
struct ForceHistory {
  Eigen::VectorXd times;                      // s, on the recording's clock
  Eigen::Matrix3Xd force, force_deviation;    // N, net force
  Eigen::Matrix3Xd torque, torque_deviation;  // N m, about the centroid of the undeformed object
  Eigen::VectorXd power;                      // W
  Eigen::Matrix3Xd centroid;  // m, centroid of the density's magnitude, undeformed object
};

struct UnexplainedForce {
  UnexplainedForceRecord record;
  ForceHistory history;  // empty if the record is not usable
  SmoothForce field;     // over model time, which is the recording's time minus `delay`
  double delay = 0;      // s
};

}  // namespace lacuna

#endif  // LACUNA_COMPARISON_UNEXPLAINED_FORCE_H_
