// A linearised misfit as linear evidence takes it: rows whitened with their noise, parameters with
// their priors.
#ifndef LACUNA_CALIBRATION_LINEAR_MISFIT_H_
#define LACUNA_CALIBRATION_LINEAR_MISFIT_H_

#include <Eigen/Core>
#include <vector>

#include "analysis/linear_evidence.h"
#include "calibration/calibration_problem.h"
#include "fit/calibration.h"

namespace lacuna {

// Priors of the problem's parameters as changes from `values`, per unit of the parameter (also
// where they are searched on a logarithmic scale).
std::vector<LinearPrior> PriorsAbout(const std::vector<CalibratedParameter>& parameters,
                                     const Eigen::VectorXd& values);

// `values` after such changes, within the parameters' bounds; a parameter on a logarithmic scale by
// their exponential.
Eigen::VectorXd MovedBy(const std::vector<CalibratedParameter>& parameters,
                        const Eigen::VectorXd& values, const Eigen::VectorXd& change);

// Rows of a linearised misfit, whitened recording by recording with its errors; of the frames that
// were fitted, or of all.
Eigen::MatrixXd WhitenedRows(const Eigen::MatrixXd& rows, const LinearisedMisfit& misfit,
                             double correlation_time, bool fitted_only);

// The noise that hypotheses are weighed with.
struct NoiseLevel {
  double correlation_time = 0;  // s
  double variance = 1;          // of the whitened rows
};

// The noise of a study, as what `left` (rows, m) is if it is noise: correlated as it is, and as
// large, but of no smaller variance than `least` times the study's.
NoiseLevel LevelOf(const Eigen::VectorXd& left, const LinearisedMisfit& misfit,
                   Eigen::Index parameters, double least);

// Rows that were observed.
Eigen::Index ObservedRows(const LinearisedMisfit& misfit);

// √ of the mean square of the observed rows that were held out (all where none were), in σ.
double HeldOutInNoise(const Eigen::VectorXd& whitened, const LinearisedMisfit& misfit);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_LINEAR_MISFIT_H_
