// Finds conflicts between a fit and its priors.
#ifndef LACUNA_CALIBRATION_PRIOR_CONFLICTS_H_
#define LACUNA_CALIBRATION_PRIOR_CONFLICTS_H_

#include <vector>

#include "calibration/calibration_problem.h"
#include "calibration/held_out_misfit.h"
#include "record/prior_conflict.h"

namespace lacuna {

// The estimates that lie more than 3 standard deviations of their prior away from its mean: places
// of markers, offsets of scanned patches, the recordings' clocks and grips; and scans that are too
// far from the prediction to be compared. In the order of the recordings. `misfits` are those of
// the fit (MisfitsOf), one per recording.
std::vector<PriorConflict> FindPriorConflicts(const CalibrationProblem& problem,
                                              const std::vector<RecordingMisfit>& misfits);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_PRIOR_CONFLICTS_H_
