// Calibration: estimates the parameters of a model from measurements, with their uncertainties.
//
// Minimises ½ ‖r(θ)‖² + ½ Σ_k ((φ_k − φ⁰_k)/s_k)² over φ, where φ_k is θ_k or its logarithm, r is
// the whitened residual (residual_function.h) and the second term holds the Gaussian priors
// (Tarantola, Inverse Problem Theory, SIAM 2005, §3.2). The minimiser takes
// Levenberg–Marquardt steps within the bounds, with the analytic Jacobian ∂r/∂θ
// (bounded_descent.h); uncertainties come from the linearisation at the solution.
#ifndef LACUNA_FIT_CALIBRATION_H_
#define LACUNA_FIT_CALIBRATION_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fit/calibrated_parameter.h"
#include "fit/calibration_options.h"
#include "fit/residual_function.h"
#include "record/parameter_estimate.h"

namespace lacuna {

// The reach of a 95 % interval in standard deviations: the 97.5 % quantile of a normal
// distribution.
inline constexpr double kNormalQuantile = 1.959963984540054;

// Vectors and lists are in the order of the parameters given.
struct Calibration {
  bool usable = false;
  std::string message;  // why the result is not usable
  // CalibrationOptions::max_predictions or max_iterations ended the search.
  bool is_out_of_budget = false;
  int iterations = 0;                        // steps of the optimiser that were tried
  int predictions = 0;                       // evaluations of the residual function
  Eigen::VectorXd parameters;                // θ, SI
  std::vector<ParameterEstimate> estimates;  // empty if the first prediction failed
  Eigen::MatrixXd covariance;     // covariance of φ with prior, `inflation` and `autocorrelation`
  double start_rms = 0, rms = 0;  // RootMeanSquare() at the start and at the solution
  double cost = 0;  // ½ ‖r‖² and half of the squares of the priors at the solution
  // √v = max(1, rms). All variances of the noise are multiplied by v, because a model that misses
  // the data by more than the noise determines its parameters less well than the noise would allow.
  double inflation = 1;
  // The lag-one autocorrelation a of the residual, limited to 0 … 0.9. Errors that persist over
  // frames make slowly varying directions less certain than independent errors would. With
  // R_ij = a^|i−j| between the frames of a quantity and the prior variances P, the covariance is
  //   H⁻¹ (Jᵀ R J/v + P⁻¹) H⁻¹,  H = JᵀJ/v + P⁻¹,
  // the sandwich estimate of least squares under correlated errors (White, Econometrica 48, 1980).
  double autocorrelation = 0;

  // Whether the first prediction has succeeded. Without parameters there are no estimates either
  // way.
  bool HasSolution() const { return usable || !estimates.empty(); }
};

// Runs the calibration. A start outside its bounds is a programming error (CHECK). If the
// prediction at the start fails, the result is not usable and carries its message; predictions that
// fail later only shorten the step.
Calibration Calibrate(const std::vector<CalibratedParameter>& parameters,
                      const ResidualFunction& predict, const CalibrationOptions& options = {});

// Sets the 95 % interval of an estimate to that of the value that a model without its known errors
// would have given: its centre (SI), and the standard deviation (of φ) that these errors add to
// that of the estimate. The value and the posterior deviation are left unchanged.
void WidenIntervalByModelErrors(const CalibratedParameter& parameter, double centre,
                                double deviation, ParameterEstimate* estimate);

// √(‖r‖²/n), where n is the number of rows that were observed; 0 if there are none.
double RootMeanSquare(const ResidualEvaluation& prediction);

}  // namespace lacuna

#endif  // LACUNA_FIT_CALIBRATION_H_
