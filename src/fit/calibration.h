// Calibration: the parameters with which a model's predictions are nearest to measurements, and
// what the measurements say about each of them.
//
// Minimises ½ ‖r(θ)‖² + ½ Σ_k ((φ_k − φ⁰_k)/s_k)² over φ, where φ_k is θ_k or its logarithm, r is
// the whitened residual (each entry of variance one if the model is right) and the second term the
// priors (Tarantola, Inverse Problem Theory, SIAM 2005, §3.2). By Ceres, with the analytic
// Jacobian ∂r/∂θ.
#ifndef LACUNA_FIT_CALIBRATION_H_
#define LACUNA_FIT_CALIBRATION_H_

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "record/parameter_estimate.h"

namespace lacuna {

struct CalibratedParameter {
  std::string name;  // for messages and records: "material.young_modulus"
  double start = 0;  // SI
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool log_scale = false;  // φ = ln θ; min must be ≥ 0
  // Prior: around `prior_mean` (NaN: `start`), s in units of φ. Infinite: none.
  double prior_mean = std::numeric_limits<double>::quiet_NaN();  // SI
  double prior_deviation = std::numeric_limits<double>::infinity();
  // A change that matters, in units of φ, > 0: what "flat" is judged by, and the fit's own unit.
  double typical = 1;
  bool is_linear = false;  // ∂r/∂θ is the same everywhere: its first value is kept
};

struct Prediction {
  bool usable = false;
  std::string message;
  Eigen::VectorXd residual;  // whitened
  Eigen::MatrixXd jacobian;  // ∂residual/∂θ; 0 × 0 where it was not asked for
  // Of each row, the row of the same quantity one frame before; −1 in its first frame. Empty: rows
  // have no order.
  std::vector<Eigen::Index> before = {};
};
// Must be a function of θ alone. `with_jacobian` false: the residual will do.
using PredictionFunction =
    std::function<Prediction(const Eigen::VectorXd& parameters, bool with_jacobian)>;

struct CalibrationOptions {
  int max_iterations = 30;  // more: slower to give up
  // Stop when a step lowers the cost by less than this share of a measurement's mean cost; smaller:
  // more iterations for changes within the intervals.
  double cost_tolerance = 0.05;
  // A start that leaves no more than this, rms in standard deviations, is near: a Jacobian there
  // and one at the end, and in between Broyden's (Math. Comp. 19, 1965), which costs no more than
  // the residuals. Where the end is none, once more from there.
  double near_rms = 0;
};

// Widens the interval by an error of the model that is known: without it `other` would be fitted,
// and the way there counts as one more standard deviation. The posterior deviation stays that of
// the fit.
void CountModelError(const CalibratedParameter& parameter, double other,
                     ParameterEstimate* estimate);

struct Calibration {
  bool usable = false;
  std::string message;
  int iterations = 0;
  int predictions = 0;
  Eigen::VectorXd parameters;
  std::vector<ParameterEstimate> estimates;
  Eigen::MatrixXd covariance;     // of φ; prior, inflation and memory included
  double start_rms = 0, rms = 0;  // √(‖r‖²/n) before and after
  // Variances are multiplied by its square: max(1, rms), as a model that misses the data by more
  // than the noise knows its parameters less well than the noise alone would let it.
  double inflation = 1;
  // a: what remains of a frame's error in the next, as the residual has it, 0 to 0.9. Errors that
  // last make slow changes less certain than as many unrelated ones would: with R_ij = a^|i−j|
  // between the frames of a quantity and P the priors' variances, the estimate's covariance is
  //   H⁻¹ (Jᵀ R J/v + P⁻¹) H⁻¹,  H = JᵀJ/v + P⁻¹,  v = inflation²
  // (least squares under correlated errors: White, Econometrica 48, 1980).
  double memory = 0;
};

// √(‖r‖²/n); 0 for an empty residual.
double RootMeanSquare(const Eigen::VectorXd& residual);

// A start outside its bounds is our own mistake (CHECK). When the very first prediction fails the
// result is not usable and says why; later ones make the step shorter.
Calibration Calibrate(const std::vector<CalibratedParameter>& parameters,
                      const PredictionFunction& predict, const CalibrationOptions& options = {});

}  // namespace lacuna

#endif  // LACUNA_FIT_CALIBRATION_H_
