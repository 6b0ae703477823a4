#include "analysis/amplitude_estimate.h"

#include <glog/logging.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace lacuna {
namespace {

constexpr int kWidths = 121;        // 20 per decade
constexpr double kAsLikely = 2;     // largest decrease of the log-likelihood of an accepted width
constexpr double kSmallest = 1e-5;  // range of √ρ, relative to the plausible width
constexpr double kLargest = 10;

// The marginal likelihood as a function of the ratio ρ = s²/v, in the eigenbasis of Lᵀ H L with the
// information H = Sᵀ C⁻¹ S.
class RatioLikelihood {
 public:
  RatioLikelihood(const Eigen::MatrixXd& information, const Eigen::VectorXd& pull,
                  double residual_square, int coordinates)
      : eigen_(0.5 * (information + information.transpose())),
        values_(eigen_.eigenvalues().array().max(0)),
        along_(eigen_.eigenvectors().transpose() * pull),
        residual_square_(residual_square),
        coordinates_(coordinates) {}

  double Variance(double ratio) const { return std::max(1.0, Rest(ratio) / coordinates_); }
  double Log(double ratio) const {
    const double v = Variance(ratio);
    return -0.5 * coordinates_ * std::log(v) - 0.5 * (1 + ratio * values_).log().sum() -
           0.5 * Rest(ratio) / v;
  }
  Eigen::VectorXd Mean(double ratio) const {
    return eigen_.eigenvectors() * (Spread(ratio) * along_).matrix();
  }
  Eigen::MatrixXd Covariance(double ratio) const {
    return Variance(ratio) * eigen_.eigenvectors() * Spread(ratio).matrix().asDiagonal() *
           eigen_.eigenvectors().transpose();
  }

 private:
  Eigen::ArrayXd Spread(double ratio) const { return ratio / (1 + ratio * values_); }
  double Rest(double ratio) const {
    return residual_square_ - (along_.square() * Spread(ratio)).sum();
  }

  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen_;
  Eigen::ArrayXd values_, along_;
  double residual_square_;  // rᵀ C⁻¹ r
  int coordinates_;
};

}  // namespace

AmplitudeEstimate EstimateAmplitudes(const FittedModel& fitted, const Eigen::MatrixXd& jacobian,
                                     int coordinates, double plausible,
                                     const std::vector<Eigen::MatrixXd>& shapes) {
  CHECK_GT(coordinates, 0);
  CHECK_GT(plausible, 0);
  CHECK(!shapes.empty());
  const Eigen::MatrixXd information = fitted.Product(jacobian, jacobian);
  const Eigen::VectorXd pull = -fitted.Product(jacobian, fitted.residual());
  const double residual_square = fitted.Product(fitted.residual(), fitted.residual())(0, 0);
  const auto ratio_of = [&](int k) {
    const double s = plausible * kSmallest *
                     std::pow(kLargest / kSmallest, static_cast<double>(k) / (kWidths - 1));
    return s * s;
  };
  std::optional<RatioLikelihood> likeliest;
  std::vector<double> logs;
  AmplitudeEstimate estimate;
  double best = -std::numeric_limits<double>::infinity();
  for (size_t shape = 0; shape < shapes.size(); ++shape) {
    const Eigen::MatrixXd& L = shapes[shape];
    RatioLikelihood likelihood(L.transpose() * information * L, L.transpose() * pull,
                               residual_square, coordinates);
    std::vector<double> of_shape;
    for (int k = 0; k < kWidths; ++k) {
      const double ratio = ratio_of(k);
      if (k > 0 && std::sqrt(ratio * likelihood.Variance(ratio)) > plausible) break;
      of_shape.push_back(likelihood.Log(ratio));
    }
    const double most = *std::max_element(of_shape.begin(), of_shape.end());
    if (shape > 0 && !(most > best)) continue;
    best = most;
    likeliest = std::move(likelihood);
    logs = std::move(of_shape);
    estimate.shape = static_cast<int>(shape);
  }
  int chosen = static_cast<int>(logs.size()) - 1;
  while (logs[chosen] < best - kAsLikely) --chosen;
  const double ratio = ratio_of(chosen), v = likeliest->Variance(ratio);
  const Eigen::MatrixXd& L = shapes[estimate.shape];
  estimate.mean = L * likeliest->Mean(ratio);
  estimate.covariance = L * likeliest->Covariance(ratio) * L.transpose();
  estimate.width = std::sqrt(ratio * v);
  estimate.noise = std::sqrt(v);
  estimate.evidence = best - likeliest->Log(0);
  return estimate;
}

}  // namespace lacuna
