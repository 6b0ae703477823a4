// How much of the squared misfit of each kind of data an effect removes.
#ifndef LACUNA_DIAGNOSIS_REMOVED_MISFIT_H_
#define LACUNA_DIAGNOSIS_REMOVED_MISFIT_H_

#include <optional>
#include <vector>

#include "calibration/calibration_problem.h"
#include "calibration/data_kinds.h"
#include "diagnosis/fitted_hypothesis.h"

namespace lacuna {

// HypothesisEvidence::misfit (σ²) of `before` minus that of `after`, both with the rows of one
// study, for each kind of data. It is negative for a kind that `after` follows worse. The parts of
// a misfit are whitened independently of one another, so that the squares of each are its own.
// `kinds`: that of each part.
ByDataKind RemovedMisfit(const FittedHypothesis& before, const FittedHypothesis& after,
                         const NoiseLevel& noise, const std::vector<DataKind>& kinds);

// RemovedMisfit() with the kinds of data of the problem's recordings. Empty where the fitted
// recordings have one kind only.
std::optional<ByDataKind> RemovedMisfit(const FittedHypothesis& before,
                                        const FittedHypothesis& after, const NoiseLevel& noise,
                                        const CalibrationProblem& problem);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_REMOVED_MISFIT_H_
