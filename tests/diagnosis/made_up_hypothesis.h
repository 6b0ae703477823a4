// A fitted model with one parameter and one nuisance, made up, for tests of the evidence of refits.
#ifndef LACUNA_TESTS_DIAGNOSIS_MADE_UP_HYPOTHESIS_H_
#define LACUNA_TESTS_DIAGNOSIS_MADE_UP_HYPOTHESIS_H_

#include <Eigen/Core>
#include <numbers>

#include "analysis/linear_evidence.h"
#include "calibration/linear_misfit.h"
#include "diagnosis/fitted_hypothesis.h"

namespace lacuna {

inline constexpr int kMadeUpFrames = 40, kMadeUpSeries = 3;  // the coordinates of one marker
inline constexpr double kMadeUpNoise = 1e-4;                 // m, of a coordinate

// One recording of one marker, whose residual is a wave and, with the opposite sign, `amount` of
// the nuisance. Its columns are those of the parameter and of the nuisance; the prior of the latter
// is 0.1 ± 0.2. All frames are fitted.
inline FittedHypothesis MakeHypothesis(double amount) {
  LinearisedMisfit misfit;
  misfit.usable = true;
  LinearisedMisfit::Part part;
  part.layout.series = kMadeUpSeries;
  part.layout.count.assign(kMadeUpSeries * kMadeUpFrames, 1);
  for (int frame = 0; frame < kMadeUpFrames; ++frame) part.layout.times.push_back(0.01 * frame);
  part.errors.noise = kMadeUpNoise;
  part.fitted.assign(kMadeUpFrames, 1);
  const Eigen::Index rows = kMadeUpSeries * kMadeUpFrames;
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(rows, 0, 1);
  misfit.jacobian.resize(rows, 2);
  misfit.jacobian.col(0) = 1e-3 * (2 * std::numbers::pi * t).array().cos();
  misfit.jacobian.col(1) = 1e-3 * t;
  misfit.residual = kMadeUpNoise * (40 * t).array().sin();
  misfit.residual -= amount * misfit.jacobian.col(1);
  misfit.parts.push_back(part);
  FittedHypothesis hypothesis;
  hypothesis.misfit = misfit;
  hypothesis.parameters = 1;
  hypothesis.priors = {{0, 1, false}, {0.1, 0.2, false}};
  hypothesis.residual = misfit.residual;
  return hypothesis;
}

// The linear model of a hypothesis with its residual and columns whitened, fitted to all frames or
// to the fitted ones.
inline LinearFit LinearFitOf(const FittedHypothesis& hypothesis, const NoiseLevel& noise,
                             bool fitted_only = false) {
  const LinearisedMisfit& misfit = hypothesis.misfit;
  const WhiteningOptions rows{.correlation_time = noise.correlation_time,
                              .fitted_only = fitted_only};
  return LinearGaussianModel(WhitenedRows(misfit.residual, misfit, rows),
                             WhitenedRows(misfit.jacobian, misfit, rows), hypothesis.priors)
      .FitAll(noise.variance);
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_DIAGNOSIS_MADE_UP_HYPOTHESIS_H_
