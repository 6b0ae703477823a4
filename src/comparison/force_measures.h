// Measures of an unexplained force: net force, torque, power, work, place, and its correlation with
// the motion.
#ifndef LACUNA_COMPARISON_FORCE_MEASURES_H_
#define LACUNA_COMPARISON_FORCE_MEASURES_H_

#include <Eigen/Core>

#include "comparison/unexplained_force.h"
#include "fem/model.h"
#include "prediction/replayed_motion.h"

namespace lacuna {

// Fills the history, and the record's net force, work, place, correlations and significance, from
// force->field and from the evidence in force->record.fit. `motion` is the motion with the
// force, at least two states. `covariance` is that of the field's amplitudes, (m/s²)², in
// column-major order of SmoothForce::amplitudes. Means over time use the trapezoidal rule.
void MeasureForce(const Model& model, const ReplayedMotion& motion,
                  const Eigen::MatrixXd& covariance, UnexplainedForce* force);

}  // namespace lacuna

#endif  // LACUNA_COMPARISON_FORCE_MEASURES_H_
