#include "fit/bounded_descent.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "fit/active_bounds.h"

namespace lacuna {
namespace {

// The fractions of the promised gain above which a step may become longer and below which the next
// one becomes shorter, and the factors by which its length changes. After a rejected step the
// factor is that of the parabola through the two costs and the slope between them, within limits,
// since a prediction is expensive and the right order of magnitude unknown. In a curved valley,
// steps that became three times as long were refused after most good ones.
constexpr double kGoodGain = 0.75, kPoorGain = 0.25;
constexpr double kLonger = 2, kShorter = 0.5, kMuchShorter = 0.1;
// A step changes no parameter by more than this many typical changes: far outside of the region
// that the data determine, a simulation takes long or fails.
constexpr double kLongestStep = 100;
// Nor does it change a parameter on a logarithmic scale by more than a factor of e. Where a time or
// a place has little influence yet, as that of an effect that is still small, the model would move
// it to the other end of its range for a small gain. A derivative by the logarithm says little
// beyond; smaller: more steps from a start that is several times too large or too small.
constexpr double kLongestLogStep = 1;
// The largest part of the way to an open bound that a step takes. The linearised model knows
// nothing of what happens at the bound, and predictions there may take tens of times longer.
constexpr double kOfWayToOpenBound = 0.8;
// Where a full step promises enough but the radius leaves only little of it, as in a curved valley,
// the search goes on to this fraction of the promise at which it ends elsewhere.
constexpr double kLeastOfCurved = 0.1;
// A bent step keeps the bend shorter than this part of the straight way: beyond, the parabola says
// less than the prediction that it comes from. Smaller: shorter bent steps. It is looked for at
// shares of the way that fall by the factor, down to the least one; these cost no prediction.
constexpr double kMostBent = 0.75;
constexpr double kNextShare = 0.8, kLeastShare = 0.05;
// A search is not called hopeless before it has made so many steps.
constexpr int kStepsBeforeHopeless = 3;
// A search whose steps become shorter than this, in typical changes, ends.
constexpr double kShortestStep = 1e-6;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A step of φ that may be tried, and the gain that it promises, as a fraction of the cost.
struct Trial {
  Eigen::VectorXd step;
  double promised = 0;
  // A bent step lies beside this share of a straight one.
  Eigen::VectorXd straight;
  double share = 1;
  bool is_bent = false;
};

class BoundedDescent {
 public:
  BoundedDescent(const std::vector<CalibratedParameter>& parameters,
                 const CalibrationOptions& options, Prediction first,
                 const PredictionFunction& predict)
      : parameters_(parameters),
        options_(options),
        predict_(predict),
        count_(static_cast<Eigen::Index>(parameters.size())),
        typical_(count_),
        low_(count_),
        high_(count_) {
    end_.parameters.resize(count_);
    end_.prediction = std::move(first);
    for (Eigen::Index k = 0; k < count_; ++k) {
      const CalibratedParameter& parameter = parameters[static_cast<size_t>(k)];
      end_.parameters[k] = parameter.start;
      typical_[k] = parameter.typical;
      low_[k] =
          parameter.log_scale && parameter.min <= 0 ? -kInfinity : ToFree(parameter, parameter.min);
      high_[k] = ToFree(parameter, parameter.max);
    }
    residuals_ = end_.prediction.residual.size();
    cost_ = CostOf(end_.prediction, end_.parameters);
    // A search without a residual is at its minimum.
    least_gain_ = options.cost_tolerance /
                  static_cast<double>(std::max<Eigen::Index>(1, end_.prediction.Observed()));
    TakeDerivatives();
  }

  DescentEnd Run() {
    for (;;) {
      const QuadraticCost model = Model();
      const Trial trial = bent_ ? *std::exchange(bent_, {}) : Straight(model, radius_);
      const bool is_there = GainsLittle(trial, model) || IsShort(trial.step);
      if (!is_there && IsUsedUp()) break;
      if (!is_there && !IsHopeless(model)) {
        Try(trial, model);
      } else if (!is_exact_) {
        // Secants may promise little where derivatives promise more.
        TakeDerivativesHere();
      } else if (is_there) {
        // If nothing near the best parameters can be predicted, they need not be a minimum.
        end_.usable = failed_beside_.empty();
        if (!end_.usable)
          end_.message = "no prediction beside the best parameters: " + failed_beside_;
        break;
      } else {
        end_.message =
            "the search was ended because it would not come close enough to the measurements";
        break;
      }
    }
    if (!is_exact_) Differentiate();
    end_.cost = cost_;
    if (!end_.usable && failed_beside_.empty() && !undifferentiable_.empty())
      end_.message += "; it could not take derivatives everywhere: " + undifferentiable_;
    return std::move(end_);
  }

 private:
  const CalibratedParameter& parameter(Eigen::Index k) const {
    return parameters_[static_cast<size_t>(k)];
  }

  Prediction Predict(const Eigen::VectorXd& values, bool with_jacobian) {
    ++end_.predictions;
    Prediction prediction = predict_(values, with_jacobian);
    if (prediction.usable)
      CHECK_EQ(prediction.residual.size(), residuals_) << "the number of residuals has changed";
    return prediction;
  }

  bool GainsLittle(const Trial& trial, const QuadraticCost& model) const {
    return !(trial.promised > kLeastOfCurved * least_gain_) ||
           (!(trial.promised > least_gain_) &&
            !(model.GainOf(Step(model, kInfinity)) > least_gain_));
  }

  bool IsShort(const Eigen::VectorXd& step) const {
    return step.cwiseQuotient(typical_).lpNorm<Eigen::Infinity>() < kShortestStep;
  }

  // Predicts the end of a step, goes there if that lowers the cost, and chooses the length of the
  // next step.
  void Try(const Trial& trial, const QuadraticCost& model) {
    ++end_.iterations;
    const double reach = LengthOf(trial.step, model);
    const Eigen::VectorXd values = Moved(trial.step);
    Prediction there = Predict(values, /*with_jacobian=*/false);
    const double cost = CostOf(there, values);
    const double gained = cost_ > 0 && std::isfinite(cost) ? 1 - cost / cost_ : -kInfinity;
    if (gained > 0) {
      const bool is_poor = gained < kPoorGain * trial.promised;
      // A poor step along secants tells less of the trust region than of the secants.
      if (gained > kGoodGain * trial.promised && rejected_ == 0)
        radius_ = std::max(radius_, kLonger * reach);
      else if (trial.is_bent && !is_poor)
        radius_ = std::max(radius_, reach);
      else if (is_poor && is_exact_)
        radius_ = kShorter * reach;
      if (is_exact_) departure_ = reach;
      MoveBy(trial.step, model, values, std::move(there), cost);
      rejected_ = 0;
      failed_beside_.clear();
      if (is_poor || !undifferentiable_.empty()) TakeDerivativesHere();
      return;
    }
    ++rejected_;
    if (!is_exact_) {
      TakeDerivativesHere();
      return;
    }
    failed_beside_ = there.usable ? "" : there.message;
    // promised / (2 promised − gained), where the cost falls by 2 promised per step at first.
    const double turn = gained > -kInfinity ? trial.promised / (2 * trial.promised - gained) : 0;
    radius_ = std::min(radius_, std::clamp(turn, kMuchShorter, kShorter) * reach);
    if (there.usable) bent_ = Bend(trial, there.residual, model);
    if (bent_ && !(bent_->promised > least_gain_)) bent_.reset();
  }

  // Takes derivatives in place of secants. Where there are none, the search goes on from the latest
  // point that has them, with shorter steps and without secants.
  void TakeDerivativesHere() {
    failed_beside_ = Differentiate();
    if (failed_beside_.empty()) return;
    undifferentiable_ = failed_beside_;
    radius_ = kMuchShorter * departure_;
    ++rejected_;
  }

  // Whether no further step may be tried; says so in the result.
  bool IsUsedUp() {
    // The first prediction was made before the search; secants need one more at its end.
    const int needed = end_.predictions + 1 + (is_exact_ ? 0 : 1);
    if (needed >= options_.max_predictions) {
      end_.message = "the search was ended after " + std::to_string(needed) +
                     " predictions, before it had converged";
    } else if (end_.iterations >= options_.max_iterations) {
      end_.message =
          "the search had not converged after " + std::to_string(end_.iterations) + " iterations";
    } else {
      return false;
    }
    end_.is_out_of_budget = true;
    return true;
  }

  // Whether the search will not come down to CalibrationOptions::hopeless_cost. In a curved valley
  // a full step gains less than there is to gain.
  bool IsHopeless(const QuadraticCost& model) const {
    return end_.iterations >= kStepsBeforeHopeless &&
           cost_ * (1 - 2 * model.GainOf(Step(model, kInfinity))) > options_.hopeless_cost;
  }

  // ½ ‖r‖² plus the priors; infinite if the prediction failed.
  double CostOf(const Prediction& prediction, const Eigen::VectorXd& values) const {
    return prediction.usable ? CostOf(prediction.residual, values) : kInfinity;
  }
  double CostOf(const Eigen::VectorXd& residual, const Eigen::VectorXd& values) const {
    double cost = residual.squaredNorm();
    for (Eigen::Index k = 0; k < count_; ++k) cost += std::pow(FromPrior(values, k), 2);
    return 0.5 * cost;
  }

  // The distance from the mean of the prior in units of its deviation; 0 without a prior.
  double FromPrior(const Eigen::VectorXd& values, Eigen::Index k) const {
    const CalibratedParameter& at = parameter(k);
    if (!std::isfinite(at.prior_deviation)) return 0;
    return (ToFree(at, values[k]) - ToFree(at, PriorMeanOf(at))) / at.prior_deviation;
  }

  // Predicts the best parameters again, with derivatives in place of secants. If that fails,
  // returns to the latest point that has derivatives, and gives the reason; empty: done.
  std::string Differentiate() {
    Prediction here = Predict(end_.parameters, /*with_jacobian=*/true);
    const std::string failed = here.usable ? "" : here.message;
    if (here.usable)
      end_.prediction = std::move(here);
    else
      std::tie(end_.parameters, end_.prediction) = differentiated_;
    cost_ = CostOf(end_.prediction, end_.parameters);
    TakeDerivatives();
    return failed;
  }

  void TakeDerivatives() {
    columns_ = end_.prediction.jacobian;
    for (Eigen::Index k = 0; k < count_; ++k)
      if (parameter(k).log_scale) columns_.col(k) *= end_.parameters[k];
    is_exact_ = true;
    differentiated_ = {end_.parameters, end_.prediction};
  }

  // Makes `values`, after this step of φ, the best parameters. The derivatives are changed such
  // that they predict the change of the residual along the step (Broyden, Math. Comput. 19, 1965),
  // by the least change in units of the curvature of each parameter.
  void MoveBy(const Eigen::VectorXd& step, const QuadraticCost& model,
              const Eigen::VectorXd& values, Prediction there, double cost) {
    const Eigen::VectorXd along = step.cwiseProduct(model.information.diagonal());
    const double length = along.dot(step);
    if (length > 0)
      columns_ += (there.residual - end_.prediction.residual - columns_ * step) *
                  (along / length).transpose();
    end_.parameters = values;
    end_.prediction = std::move(there);
    cost_ = cost;
    is_exact_ = false;
  }

  // The cost about the best parameters as a quadratic function of a step of φ.
  QuadraticCost Model() const {
    QuadraticCost model{cost_, columns_.transpose() * end_.prediction.residual,
                        columns_.transpose() * columns_};
    for (Eigen::Index k = 0; k < count_; ++k) {
      const double deviation = parameter(k).prior_deviation;
      if (!std::isfinite(deviation)) continue;
      model.gradient[k] += FromPrior(end_.parameters, k) / deviation;
      model.information(k, k) += 1 / (deviation * deviation);
    }
    return model;
  }

  // The length of a step relative to the curvature of each parameter alone: ‖√(diag H) step‖.
  static double LengthOf(const Eigen::VectorXd& step, const QuadraticCost& model) {
    return step.cwiseProduct(model.information.diagonal().cwiseSqrt()).norm();
  }

  Trial Straight(const QuadraticCost& model, double radius) const {
    Trial trial;
    trial.step = trial.straight = Step(model, radius);
    trial.promised = model.GainOf(trial.step);
    return trial;
  }

  // A refused step δ shows how the residual bends along it: r(φ + tδ) ≈ r + t Jδ + t² c. The path
  // φ + tδ + t²a, with the a that compensates best for c, follows a curved valley (geodesic
  // acceleration: Transtrum & Sethna, arXiv:1201.5885, 2012, who spend one more prediction on c).
  // The trial is its best point; after a refused bent step, the best one of its first half, with
  // the c that this step shows. `there`: the residual after the refused step.
  std::optional<Trial> Bend(const Trial& refused, const Eigen::VectorXd& there,
                            const QuadraticCost& model) const {
    const Eigen::VectorXd& residual = end_.prediction.residual;
    const Eigen::VectorXd along = columns_ * refused.straight;
    const Eigen::VectorXd curvature =
        (there - residual - columns_ * refused.step) / (refused.share * refused.share);
    QuadraticCost compensation = model;
    compensation.gradient = columns_.transpose() * curvature;
    const Eigen::VectorXd bend = DampedStep(compensation, 0);
    const Eigen::VectorXd left = curvature + columns_ * bend;
    const double longest = std::min(
        refused.is_bent ? 0.5 * refused.share : 1.0,
        kMostBent * LengthOf(refused.straight, model) / std::max(LengthOf(bend, model), 1e-300));
    const auto [low, high] = Room();
    std::optional<Trial> best;
    for (double share = longest; share > kLeastShare; share *= kNextShare) {
      const Eigen::VectorXd step = share * refused.straight + share * share * bend;
      Trial trial{step.cwiseMax(typical_.cwiseProduct(low)).cwiseMin(typical_.cwiseProduct(high)),
                  0, refused.straight, share, true};
      const Eigen::VectorXd expected = residual + share * along + share * share * left;
      trial.promised = 1 - CostOf(expected, Moved(trial.step)) / cost_;
      if (!best || trial.promised > best->promised) best = std::move(trial);
    }
    return best;
  }

  // The step of φ within the bounds that minimises the model and is not longer than `radius`: that
  // of the model with λ diag H added to H, for the least λ ≥ 0 that makes it short enough.
  Eigen::VectorXd Step(const QuadraticCost& model, double radius) const {
    Eigen::VectorXd step = DampedStep(model, 0);
    if (!(LengthOf(step, model) > radius)) return step;
    double low = -8, high = 8;  // of log10 λ
    while (high - low > 0.05) {
      const double middle = 0.5 * (low + high);
      step = DampedStep(model, std::pow(10, middle));
      (LengthOf(step, model) > radius ? low : high) = middle;
    }
    return DampedStep(model, std::pow(10, high));
  }

  // The least and the largest step of each φ, in typical changes.
  std::pair<Eigen::VectorXd, Eigen::VectorXd> Room() const {
    Eigen::VectorXd low(count_), high(count_);
    for (Eigen::Index k = 0; k < count_; ++k) {
      const CalibratedParameter& at = parameter(k);
      const double here = ToFree(at, end_.parameters[k]);
      const double down = (at.open_min ? kOfWayToOpenBound : 1) * (low_[k] - here);
      const double up = (at.open_max ? kOfWayToOpenBound : 1) * (high_[k] - here);
      const double longest = at.log_scale ? kLongestLogStep / typical_[k] : kLongestStep;
      low[k] = std::clamp(down / typical_[k], -longest, 0.0);
      high[k] = std::clamp(up / typical_[k], 0.0, longest);
    }
    return {low, high};
  }

  Eigen::VectorXd DampedStep(const QuadraticCost& model, double damping) const {
    // In units of the typical changes, in which directions without influence are told from others.
    QuadraticCost scaled{model.cost, typical_.cwiseProduct(model.gradient),
                         typical_.asDiagonal() * model.information * typical_.asDiagonal()};
    scaled.information.diagonal() *= 1 + damping;
    const auto [low, high] = Room();
    return typical_.cwiseProduct(StepWithin(scaled, low, high));
  }

  // The values after a step of φ. A step that ends at a bound gives the bound itself.
  Eigen::VectorXd Moved(const Eigen::VectorXd& step) const {
    Eigen::VectorXd values(count_);
    for (Eigen::Index k = 0; k < count_; ++k) {
      const CalibratedParameter& at = parameter(k);
      const double there = ToFree(at, end_.parameters[k]) + step[k];
      const double at_bound = 1e-12 * std::max(at.typical, std::abs(there));
      values[k] = there - low_[k] <= at_bound    ? at.min
                  : high_[k] - there <= at_bound ? at.max
                                                 : FromFree(at, there);
    }
    return values;
  }

  const std::vector<CalibratedParameter>& parameters_;
  const CalibrationOptions& options_;
  const PredictionFunction& predict_;
  const Eigen::Index count_;
  Eigen::Index residuals_ = 0;
  Eigen::VectorXd typical_, low_, high_;  // of φ
  DescentEnd end_;
  double cost_ = 0;        // at the best parameters
  double least_gain_ = 0;  // a fraction of the cost; steps that promise less end the search
  // n × parameters, ∂r/∂φ there: derivatives, or secants since a step was made.
  Eigen::MatrixXd columns_;
  bool is_exact_ = false;
  std::pair<Eigen::VectorXd, Prediction> differentiated_;  // the latest point with derivatives
  double departure_ = 0;                                   // length of the first step from there
  double radius_ = kInfinity;                              // of the trust region
  int rejected_ = 0;                                       // consecutive steps
  std::string failed_beside_;     // why the last of them could not be predicted
  std::string undifferentiable_;  // why derivatives could not be computed at some point
  std::optional<Trial> bent_;     // to be tried next
};

}  // namespace

DescentEnd Descend(const std::vector<CalibratedParameter>& parameters,
                   const CalibrationOptions& options, Prediction first,
                   const PredictionFunction& predict) {
  return BoundedDescent(parameters, options, std::move(first), predict).Run();
}

}  // namespace lacuna
