// The load cell at the clamp of a sealed case.
//
// A reading that is stamped t is the force that the clamp exerts on the true bar at t − delay, plus
// an offset, plus white noise. Offset and delay are those of one recording.
#ifndef LACUNA_TRIALS_TRIAL_LOAD_CELL_H_
#define LACUNA_TRIALS_TRIAL_LOAD_CELL_H_

#include <Eigen/Core>
#include <vector>

#include "scan/measured_reaction.h"
#include "trials/trial_case.h"

namespace lacuna {

// The offset of each component, N, and the delay, s, in a recording of a case with a load cell
// (CHECKed). They depend on the seed of the case and the number of the recording alone.
Eigen::Vector3d CellTare(const TrialCase& trial, int recording);
double CellDelay(const TrialCase& trial, int recording);

// The times at which the force is taken of readings that are stamped with `stamps` (s); empty for a
// case without a load cell.
std::vector<double> CellTimes(const TrialCase& trial, int recording,
                              const std::vector<double>& stamps);

// The reading of the clamp, which is the only part of the bar that is held, with noise; `forces`
// (3 × stamps, N) are those at CellTimes().
MeasuredReaction CellReading(const TrialCase& trial, int recording,
                             const std::vector<double>& stamps, const Eigen::Matrix3Xd& forces);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_TRIAL_LOAD_CELL_H_
