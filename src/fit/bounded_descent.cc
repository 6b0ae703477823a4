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
#include "fit/bounded_steps.h"
#include "fit/prior_cost.h"

namespace lacuna {
namespace {

// The gain of a step is compared with the predicted one. Above the first of these fractions of it
// the next step may become longer, below the second it becomes shorter.
constexpr double kGoodGain = 0.75, kPoorGain = 0.25;
// The factor by which the trust region grows beyond a good step. In a curved valley, steps that
// became three times as long were refused after most good ones.
constexpr double kLonger = 2;
// The factors by which the trust region shrinks: the first after a poor step. After a refused step
// the factor is that of the parabola through the two costs and the slope between them, limited to
// the range between the two, since a prediction is expensive and the right order of magnitude
// unknown.
constexpr double kShorter = 0.5, kMuchShorter = 0.1;
// The search ends where both a full step and the step within the trust region are predicted to gain
// too little. Where only the second one is, as in a curved valley, the search goes on down to this
// fraction of the gain at which it ends elsewhere. A smaller value costs more short steps.
constexpr double kLeastShareOfGain = 0.1;
// The largest length of the acceleration term of a geodesic step relative to that of its velocity
// term (cf. the limit α of Transtrum & Sethna 2012). Beyond it, the parabola is less reliable than
// the one prediction from which it was made. A smaller value shortens geodesic steps.
constexpr double kLargestAccelerationRatio = 0.75;
// The scale of a geodesic step is chosen among the largest one and those that follow from it by
// this factor, above the least scale. No prediction is needed for the choice.
constexpr double kScaleFactor = 0.8, kLeastScale = 0.05;
// A search is not called hopeless before it has tried this many steps, because the first ones may
// gain less than those that follow.
constexpr int kStepsBeforeHopeless = 3;
// A search ends whose steps become shorter than this, in typical changes.
constexpr double kShortestStep = 1e-6;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A step of φ that may be tried.
struct Trial {
  Eigen::VectorXd step;
  double predicted_gain = 0;  // as a fraction of the cost
  // A geodesic step is scale · velocity + scale² · acceleration within the bounds. The velocity is
  // the straight step that was refused before it; a straight step is its own velocity.
  Eigen::VectorXd velocity;
  double scale = 1;
  bool is_geodesic = false;
};

class BoundedDescent {
 public:
  BoundedDescent(const std::vector<CalibratedParameter>& parameters,
                 const CalibrationOptions& options, ResidualEvaluation first,
                 const ResidualFunction& predict)
      : parameters_(parameters),
        options_(options),
        predict_(predict),
        steps_(parameters),
        count_(static_cast<Eigen::Index>(parameters.size())) {
    end_.parameters.resize(count_);
    end_.prediction = std::move(first);
    for (Eigen::Index k = 0; k < count_; ++k) end_.parameters[k] = parameter(k).start;
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
      const Trial trial = geodesic_ ? *std::exchange(geodesic_, {}) : Straight(model, radius_);
      const bool is_there = GainsLittle(trial, model) || IsShort(trial.step);
      if (!is_there && IsUsedUp()) break;
      if (!is_there && !IsHopeless(model)) {
        Try(trial, model);
      } else if (!is_exact_) {
        // Secants may predict little gain where derivatives predict more.
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

  ResidualEvaluation Predict(const Eigen::VectorXd& values, bool with_jacobian) {
    ++end_.predictions;
    ResidualEvaluation prediction = predict_(values, with_jacobian);
    if (prediction.usable)
      CHECK_EQ(prediction.residual.size(), residuals_) << "the number of residuals has changed";
    return prediction;
  }

  bool GainsLittle(const Trial& trial, const QuadraticCost& model) const {
    return !(trial.predicted_gain > kLeastShareOfGain * least_gain_) ||
           (!(trial.predicted_gain > least_gain_) &&
            !(model.GainOf(FullStep(model)) > least_gain_));
  }

  bool IsShort(const Eigen::VectorXd& step) const {
    return steps_.LargestChange(step) < kShortestStep;
  }

  // Predicts the end of a step, goes there if that lowers the cost, and chooses the length of the
  // next step.
  void Try(const Trial& trial, const QuadraticCost& model) {
    ++end_.iterations;
    const double reach = BoundedSteps::LengthOf(trial.step, model);
    const Eigen::VectorXd values = steps_.Moved(trial.step, end_.parameters);
    ResidualEvaluation there = Predict(values, /*with_jacobian=*/false);
    const double cost = CostOf(there, values);
    const double gained = cost_ > 0 && std::isfinite(cost) ? 1 - cost / cost_ : -kInfinity;
    if (gained > 0) {
      const bool is_poor = gained < kPoorGain * trial.predicted_gain;
      // A poor step along secants reveals an error of the secants rather than of the trust region.
      if (gained > kGoodGain * trial.predicted_gain && rejected_ == 0)
        radius_ = std::max(radius_, kLonger * reach);
      else if (trial.is_geodesic && !is_poor)
        radius_ = std::max(radius_, reach);
      else if (is_poor && is_exact_)
        radius_ = kShorter * reach;
      if (is_exact_) first_length_ = reach;
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
    // At first the cost falls by twice the predicted gain per step.
    const double turn =
        gained > -kInfinity ? trial.predicted_gain / (2 * trial.predicted_gain - gained) : 0;
    radius_ = std::min(radius_, std::clamp(turn, kMuchShorter, kShorter) * reach);
    if (there.usable) geodesic_ = GeodesicStep(trial, there.residual, model);
    if (geodesic_ && !(geodesic_->predicted_gain > least_gain_)) geodesic_.reset();
  }

  // Takes derivatives in place of secants. Where there are none, the search goes on from the latest
  // point that has them, with shorter steps and without secants.
  void TakeDerivativesHere() {
    failed_beside_ = Differentiate();
    if (failed_beside_.empty()) return;
    undifferentiable_ = failed_beside_;
    radius_ = kMuchShorter * first_length_;
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
           cost_ * (1 - 2 * model.GainOf(FullStep(model))) > options_.hopeless_cost;
  }

  // ½ ‖r‖² plus the priors; infinite if the prediction failed.
  double CostOf(const ResidualEvaluation& prediction, const Eigen::VectorXd& values) const {
    return prediction.usable ? CostAt(parameters_, values, prediction.residual) : kInfinity;
  }

  // Predicts the best parameters again, with derivatives in place of secants. If that fails,
  // returns to the latest point that has derivatives, and gives the reason; empty: done.
  std::string Differentiate() {
    ResidualEvaluation here = Predict(end_.parameters, /*with_jacobian=*/true);
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
    DeriveByFreeValues(parameters_, end_.parameters, &columns_);
    is_exact_ = true;
    differentiated_ = {end_.parameters, end_.prediction};
  }

  // Makes `values`, after this step of φ, the best parameters. The derivatives are changed such
  // that they predict the change of the residual along the step (Broyden, Math. Comput. 19, 1965),
  // by the least change in units of the curvature of each parameter.
  void MoveBy(const Eigen::VectorXd& step, const QuadraticCost& model,
              const Eigen::VectorXd& values, ResidualEvaluation there, double cost) {
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
    return CostAbout(parameters_, end_.parameters, end_.prediction.residual, columns_);
  }

  Eigen::VectorXd FullStep(const QuadraticCost& model) const {
    return steps_.Step(model, end_.parameters, kInfinity);
  }

  Trial Straight(const QuadraticCost& model, double radius) const {
    Trial trial;
    trial.step = trial.velocity = steps_.Step(model, end_.parameters, radius);
    trial.predicted_gain = model.GainOf(trial.step);
    return trial;
  }

  // A refused step δ reveals the curvature of the residual along it: r(φ + tδ) ≈ r + t Jδ + t² c.
  // The path φ + tδ + t²a, with the acceleration a that compensates best for c, follows a curved
  // valley (geodesic acceleration: Transtrum & Sethna, arXiv:1201.5885, 2012, who spend one more
  // prediction on c). The trial is the point of this path with the largest predicted gain; after a
  // refused geodesic step, that of the first half of its path, with the c that this step reveals.
  // `there`: the residual after the refused step.
  std::optional<Trial> GeodesicStep(const Trial& refused, const Eigen::VectorXd& there,
                                    const QuadraticCost& model) const {
    const Eigen::VectorXd& residual = end_.prediction.residual;
    const Eigen::VectorXd change = columns_ * refused.velocity;
    const Eigen::VectorXd curvature =
        (there - residual - columns_ * refused.step) / (refused.scale * refused.scale);
    QuadraticCost compensation = model;
    compensation.gradient = columns_.transpose() * curvature;
    const Eigen::VectorXd acceleration = FullStep(compensation);
    const Eigen::VectorXd remaining_curvature = curvature + columns_ * acceleration;
    const double largest_scale =
        std::min(refused.is_geodesic ? 0.5 * refused.scale : 1.0,
                 kLargestAccelerationRatio * BoundedSteps::LengthOf(refused.velocity, model) /
                     std::max(BoundedSteps::LengthOf(acceleration, model), 1e-300));
    std::optional<Trial> best;
    for (double scale = largest_scale; scale > kLeastScale; scale *= kScaleFactor) {
      const Eigen::VectorXd step = scale * refused.velocity + scale * scale * acceleration;
      Trial trial{steps_.Limited(step, end_.parameters), 0, refused.velocity, scale, true};
      const Eigen::VectorXd expected =
          residual + scale * change + scale * scale * remaining_curvature;
      trial.predicted_gain =
          1 - CostAt(parameters_, steps_.Moved(trial.step, end_.parameters), expected) / cost_;
      if (!best || trial.predicted_gain > best->predicted_gain) best = std::move(trial);
    }
    return best;
  }

  const std::vector<CalibratedParameter>& parameters_;
  const CalibrationOptions& options_;
  const ResidualFunction& predict_;
  const BoundedSteps steps_;
  const Eigen::Index count_;
  Eigen::Index residuals_ = 0;
  DescentEnd end_;
  double cost_ = 0;        // at the best parameters
  double least_gain_ = 0;  // a fraction of the cost; steps with less predicted gain end the search
  // n × parameters, ∂r/∂φ there: derivatives, or secants since a step was made.
  Eigen::MatrixXd columns_;
  bool is_exact_ = false;
  // The latest point with derivatives.
  std::pair<Eigen::VectorXd, ResidualEvaluation> differentiated_;
  double first_length_ = 0;        // of the first step from there
  double radius_ = kInfinity;      // of the trust region
  int rejected_ = 0;               // consecutive steps
  std::string failed_beside_;      // why the last of them could not be predicted
  std::string undifferentiable_;   // why derivatives could not be computed at some point
  std::optional<Trial> geodesic_;  // to be tried next
};

}  // namespace

DescentEnd Descend(const std::vector<CalibratedParameter>& parameters,
                   const CalibrationOptions& options, ResidualEvaluation first,
                   const ResidualFunction& predict) {
  return BoundedDescent(parameters, options, std::move(first), predict).Run();
}

}  // namespace lacuna
