// The kinds of data that the fitted recordings have: markers, scans and forces.
#ifndef LACUNA_CALIBRATION_DATA_KINDS_H_
#define LACUNA_CALIBRATION_DATA_KINDS_H_

#include <Eigen/Core>
#include <vector>

#include "calibration/calibration_problem.h"
#include "record/by_data_kind.h"

namespace lacuna {

// Whether the fitted recordings have several kinds of data.
bool HasSeveralKinds(const CalibrationProblem& problem);

// The kind of data of each part of a misfit of the problem.
std::vector<DataKind> KindsOfParts(const LinearisedMisfit& misfit,
                                   const CalibrationProblem& problem);

// The sums of `values`, one for each row of the misfit, over the rows of each kind of data.
// `kinds`: that of each part. CHECKs the sizes.
ByDataKind SumsByKind(const Eigen::VectorXd& values, const LinearisedMisfit& misfit,
                      const std::vector<DataKind>& kinds);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_DATA_KINDS_H_
