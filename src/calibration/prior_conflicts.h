// Finds conflicts between a fit and its priors.
#ifndef LACUNA_CALIBRATION_PRIOR_CONFLICTS_H_
#define LACUNA_CALIBRATION_PRIOR_CONFLICTS_H_

#include <Eigen/Core>
#include <vector>

#include "calibration/calibration_problem.h"
#include "calibration/held_out_misfit.h"
#include "record/prior_conflict.h"

namespace lacuna {

// The estimates that lie too far from the mean of their prior: the model's parameters and the
// recordings' clocks and grips, beyond 3 standard deviations; places of markers and offsets of
// scanned patches, beyond the distance that any of a recording's offsets exceeds with the same
// probability of 0.27 % if the prior holds (of 8 markers 4.3 standard deviations, of 150
// patches 4.3); and scans that are too far from the prediction to be compared. The model's
// parameters come first, then the recordings in their order. `values` are the estimates of the
// problem's parameters (SI), `misfits` those of the fit (MisfitsOf), one per recording.
std::vector<PriorConflict> FindPriorConflicts(const CalibrationProblem& problem,
                                              const Eigen::VectorXd& values,
                                              const std::vector<RecordingMisfit>& misfits);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_PRIOR_CONFLICTS_H_
