// Compares what the recordings of a fit say about the parameters of its model.
//
// The estimate of each recording is the Gauss–Newton step from the joint fit with that recording's
// own rows (analysis/agreement.h). It is accurate as far as the predictions are linear over the
// differences, which are small where recordings agree.
#ifndef LACUNA_DIAGNOSIS_RECORDING_AGREEMENT_H_
#define LACUNA_DIAGNOSIS_RECORDING_AGREEMENT_H_

#include <Eigen/Core>

#include "calibration/calibration_problem.h"
#include "calibration/linear_misfit.h"
#include "diagnosis/scored_effect.h"
#include "record/agreement_record.h"

namespace lacuna {

// Markers of two recordings that sit at the same places of the object have the same errors of
// these places; of more markers than this the errors are taken to be independent.
inline constexpr Eigen::Index kMostSharedMarkers = 60;

// `misfit`: of the problem at the fitted `values`, with the columns of its parameters first.
// `shared`: nuisances of the model, with the same amounts in all recordings. `model_error`: of the
// model in any direction (EffectRanking::ModelError()), which explains differences, too. Empty
// where fewer than two recordings were fitted or no parameter of the model was.
AgreementRecord CompareRecordings(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                                  const LinearisedMisfit& misfit, const AdoptedNuisances& shared,
                                  const NoiseLevel& noise, double model_error = 0);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_RECORDING_AGREEMENT_H_
