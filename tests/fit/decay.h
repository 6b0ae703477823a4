// An exponential decay with two unknowns, to which calibrations are fitted.
#ifndef LACUNA_TESTS_FIT_DECAY_H_
#define LACUNA_TESTS_FIT_DECAY_H_

#include <Eigen/Core>
#include <random>
#include <vector>

#include "fit/calibrated_parameter.h"
#include "fit/residual_function.h"

namespace lacuna {

// a·exp(−t/τ) at 40 times, with noise of a given deviation, which is also the unit of the residual.
struct Decay {
  Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(40, 0, 2);
  Eigen::VectorXd measured;
  double noise = 0.01;

  Decay(double amplitude, double tau, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, noise);
    measured = amplitude * (-times / tau).array().exp().matrix();
    for (double& value : measured) value += normal(random);
  }

  ResidualEvaluation operator()(const Eigen::VectorXd& at, bool with_jacobian) const {
    const Eigen::VectorXd shape = (-times / at[1]).array().exp();
    ResidualEvaluation prediction{true, "", (at[0] * shape - measured) / noise, {}};
    if (with_jacobian) {
      prediction.jacobian.resize(times.size(), 2);
      prediction.jacobian.col(0) = shape / noise;
      prediction.jacobian.col(1) = at[0] * shape.cwiseProduct(times) / (at[1] * at[1] * noise);
    }
    return prediction;
  }
};

inline std::vector<CalibratedParameter> AmplitudeAndTime() {
  return {{.name = "amplitude", .start = 1, .min = 0, .max = 10, .typical = 1},
          {.name = "tau", .start = 0.2, .min = 0.01, .max = 100, .log_scale = true}};
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_FIT_DECAY_H_
