#include "fit/bounded_descent.h"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "fit/active_bounds.h"

namespace lacuna {
namespace {

// A start within kAtBound of a bound, in typical changes, cannot move in the unbounded coordinate
// and is placed kInside of the bound. Starts farther away are kept, because a typical change may be
// much larger than the uncertainty that the data allow.
constexpr double kAtBound = 1e-6, kInside = 0.02;
// Rounds with Broyden updates of a fit that starts near; if they do not suffice, it was not near.
constexpr int kSecantRounds = 3;
// Radius of the first trust region, in typical changes. A step that overshoots is shortened at
// once.
constexpr double kFirstRadius = 100;
// Within kAtTurn of its bound, in typical changes, φ(u) reaches its turning point and ∂φ/∂u nearly
// vanishes: steps towards the bound then cover half of the distance, and steps beyond the turning
// point are rejected until the trust region is too small for all other parameters. A round ends
// after kAtTurnSteps consecutive iterations of this kind.
constexpr double kAtTurn = 0.01;
constexpr int kAtTurnSteps = 3;
// Fractions of a bounded Gauss–Newton step that are tried in turn.
constexpr double kParts[] = {1, 0.25, 0.06};

// The coordinate in which Ceres works: u, unbounded, in typical changes of φ. At a bound φ(u) has a
// turning point, so that no step leaves the bounds and none has to be clipped (as in Minuit: James
// & Roos, Comput. Phys. Commun. 10, 1975):
//   two bounds   φ = middle + half sin((u − middle)/half)
//   one bound    φ = low − 1 + √((u − low)² + 1),            and correspondingly from above
struct UnboundedCoordinate {
  double low, high;  // bounds of φ/typical

  explicit UnboundedCoordinate(const CalibratedParameter& parameter)
      : low(parameter.log_scale && parameter.min <= 0
                ? -std::numeric_limits<double>::infinity()
                : ToFree(parameter, parameter.min) / parameter.typical),
        high(ToFree(parameter, parameter.max) / parameter.typical) {}

  // φ/typical and its derivative with respect to u.
  std::pair<double, double> At(double u) const {
    const bool has_low = std::isfinite(low), has_high = std::isfinite(high);
    if (has_low && has_high) {
      const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
      if (half == 0) return {middle, 0};
      const double t = (u - middle) / half;
      return {middle + half * std::sin(t), std::cos(t)};
    }
    if (!has_low && !has_high) return {u, 1};
    const double inside = has_low ? u - low : high - u;
    const double root = std::sqrt(inside * inside + 1);
    return {has_low ? low + (root - 1) : high - (root - 1), inside / root};
  }

  bool IsAtTurn(double scaled) const {
    const double near = kAtTurn * std::min(1.0, high - low);
    return scaled - low <= near || high - scaled <= near;
  }
  // A start on a bound is moved inside, because the search could not leave the bound.
  double MovedInside(double scaled) const {
    const double inside = std::min(kInside, 0.5 * (high - low));
    return scaled - low < kAtBound    ? low + inside
           : high - scaled < kAtBound ? high - inside
                                      : scaled;
  }
  // The inverse: u for a given φ/typical.
  double From(double scaled) const {
    const bool has_low = std::isfinite(low), has_high = std::isfinite(high);
    if (has_low && has_high) {
      const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
      if (half == 0) return middle;
      return middle + half * std::asin(std::clamp((scaled - middle) / half, -1.0, 1.0));
    }
    if (!has_low && !has_high) return scaled;
    const double inside = std::max(0.0, has_low ? scaled - low : high - scaled) + 1;
    const double root = std::sqrt(inside * inside - 1);
    return has_low ? low + root : high - root;
  }
};

class PredictionCost : public ceres::CostFunction {
 public:
  PredictionCost(const std::vector<CalibratedParameter>& parameters, int residuals,
                 SecantPredictions* predictions)
      : parameters_(parameters), predictions_(*predictions) {
    set_num_residuals(residuals);
    for (size_t k = 0; k < parameters.size(); ++k) mutable_parameter_block_sizes()->push_back(1);
  }

  bool Evaluate(double const* const* free, double* residuals, double** jacobians) const override {
    const int count = static_cast<int>(parameters_.size());
    Eigen::VectorXd values(count), slopes(count);
    for (int k = 0; k < count; ++k) {
      const auto [scaled, slope] = UnboundedCoordinate(parameters_[k]).At(free[k][0]);
      values[k] = FromFree(parameters_[k], scaled * parameters_[k].typical);
      slopes[k] = slope * parameters_[k].typical * (parameters_[k].log_scale ? values[k] : 1);
    }
    const Prediction& prediction = predictions_.At(values);
    if (!prediction.usable) return false;
    CHECK_EQ(prediction.residual.size(), num_residuals()) << "the number of residuals has changed";
    Eigen::Map<Eigen::VectorXd>(residuals, num_residuals()) = prediction.residual;
    if (jacobians == nullptr) return true;
    for (int k = 0; k < count; ++k) {
      if (jacobians[k] == nullptr) continue;
      Eigen::Map<Eigen::VectorXd>(jacobians[k], num_residuals()) =
          slopes[k] * prediction.jacobian.col(k);
    }
    return true;
  }

 private:
  const std::vector<CalibratedParameter>& parameters_;
  SecantPredictions& predictions_;
};

class PriorCost : public ceres::SizedCostFunction<1, 1> {
 public:
  // `centre` and `deviation` are those of φ/typical.
  PriorCost(const UnboundedCoordinate& coordinate, double centre, double deviation)
      : coordinate_(coordinate), centre_(centre), deviation_(deviation) {}
  bool Evaluate(double const* const* free, double* residuals, double** jacobians) const override {
    const auto [scaled, slope] = coordinate_.At(free[0][0]);
    residuals[0] = (scaled - centre_) / deviation_;
    if (jacobians != nullptr && jacobians[0] != nullptr) jacobians[0][0] = slope / deviation_;
    return true;
  }

 private:
  UnboundedCoordinate coordinate_;
  double centre_, deviation_;
};

// ½ ‖r‖² plus the priors; infinite if the prediction failed.
double CostOf(const Prediction& prediction, const std::vector<CalibratedParameter>& parameters,
              const Eigen::VectorXd& values) {
  if (!prediction.usable) return std::numeric_limits<double>::infinity();
  double cost = prediction.residual.squaredNorm();
  for (size_t k = 0; k < parameters.size(); ++k) {
    const CalibratedParameter& parameter = parameters[k];
    if (!std::isfinite(parameter.prior_deviation)) continue;
    const double away = ToFree(parameter, values[static_cast<Eigen::Index>(k)]) -
                        ToFree(parameter, PriorMeanOf(parameter));
    cost += std::pow(away / parameter.prior_deviation, 2);
  }
  return 0.5 * cost;
}

// ½ ‖r‖² plus the priors as a quadratic function of φ/typical, from the linearised residual.
QuadraticCost ModelOf(const Prediction& prediction,
                      const std::vector<CalibratedParameter>& parameters,
                      const Eigen::VectorXd& values) {
  Eigen::MatrixXd J = prediction.jacobian;
  for (size_t k = 0; k < parameters.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    J.col(at) *= parameters[k].typical * (parameters[k].log_scale ? values[at] : 1);
  }
  QuadraticCost model{CostOf(prediction, parameters, values), J.transpose() * prediction.residual,
                      J.transpose() * J};
  for (size_t k = 0; k < parameters.size(); ++k) {
    const CalibratedParameter& parameter = parameters[k];
    if (!std::isfinite(parameter.prior_deviation)) continue;
    const auto at = static_cast<Eigen::Index>(k);
    const double away = ToFree(parameter, values[at]) - ToFree(parameter, PriorMeanOf(parameter));
    const double unit = parameter.typical / parameter.prior_deviation;
    model.gradient[at] += unit * away / parameter.prior_deviation;
    model.information(at, at) += unit * unit;
  }
  return model;
}

// Moves parameters that have nearly reached a bound onto it, unless this raises the cost
// noticeably.
void SnapToBounds(const std::vector<CalibratedParameter>& parameters,
                  SecantPredictions* predictions, Eigen::VectorXd* values) {
  constexpr double kNoWorse = 0.5;  // the cost of one residual of one standard deviation
  Eigen::VectorXd snapped = *values;
  for (size_t k = 0; k < parameters.size(); ++k) {
    const CalibratedParameter& parameter = parameters[k];
    double& value = snapped[static_cast<Eigen::Index>(k)];
    const double now = ToFree(parameter, value), near = 2 * kInside * parameter.typical;
    const bool has_low = !(parameter.log_scale && parameter.min <= 0);
    if (has_low && now - ToFree(parameter, parameter.min) < near) value = parameter.min;
    if (ToFree(parameter, parameter.max) - now < near) value = parameter.max;
  }
  if (snapped == *values) return;
  const double before = CostOf(predictions->ExactAt(*values), parameters, *values);
  const Prediction there = predictions->WithoutJacobianAt(snapped);
  if (CostOf(there, parameters, snapped) <= before + kNoWorse) *values = snapped;
}

// Ends a round in which a parameter stays at the turning point of its coordinate.
class UntilAtTurn : public ceres::IterationCallback {
 public:
  explicit UntilAtTurn(std::function<bool()> is_at_turn) : is_at_turn_(std::move(is_at_turn)) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& step) override {
    steps_ = step.iteration > 0 && is_at_turn_() ? steps_ + 1 : 0;
    return steps_ >= kAtTurnSteps ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  std::function<bool()> is_at_turn_;
  int steps_ = 0;
};

// Ends a round once a number of predictions has been made.
class UntilOutOfBudget : public ceres::IterationCallback {
 public:
  UntilOutOfBudget(const SecantPredictions& predictions, int most)
      : predictions_(predictions), most_(most) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*step*/) override {
    return IsUsedUp() ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }
  bool IsUsedUp() const { return predictions_.count() >= most_; }

 private:
  const SecantPredictions& predictions_;
  const int most_;
};

// The trust-region radius for the next round: that of the last accepted step, because each rejected
// step shrinks the radius faster than the one before.
double NextRadius(const ceres::Solver::Summary& summary) {
  for (auto step = summary.iterations.rbegin(); step != summary.iterations.rend(); ++step)
    if (step->iteration == 0 || step->step_is_successful)
      return std::min(kFirstRadius, step->trust_region_radius);
  return kFirstRadius;
}

// Runs Ceres in rounds, with bounded Gauss–Newton steps in between. Needs at least one parameter.
class BoundedDescent {
 public:
  BoundedDescent(const std::vector<CalibratedParameter>& parameters,
                 const CalibrationOptions& options, const Prediction& first,
                 SecantPredictions* predictions)
      : parameters_(parameters), options_(options), predictions_(*predictions) {
    for (const CalibratedParameter& parameter : parameters) {
      const UnboundedCoordinate bounds(parameter);
      bounds_.push_back(bounds);
      free_.push_back(
          bounds.From(bounds.MovedInside(ToFree(parameter, parameter.start) / parameter.typical)));
    }
    for (double& value : free_) blocks_.push_back(&value);
    problem_.AddResidualBlock(
        new PredictionCost(parameters, static_cast<int>(first.residual.size()), predictions),
        nullptr, blocks_);
    for (size_t k = 0; k < parameters.size(); ++k) {
      const CalibratedParameter& parameter = parameters[k];
      if (!std::isfinite(parameter.prior_deviation)) continue;
      problem_.AddResidualBlock(
          new PriorCost(bounds_[k], ToFree(parameter, PriorMeanOf(parameter)) / parameter.typical,
                        parameter.prior_deviation / parameter.typical),
          nullptr, blocks_[k]);
    }
    solver_.linear_solver_type = ceres::DENSE_QR;
    solver_.function_tolerance =
        options.cost_tolerance /
        static_cast<double>(std::max<Eigen::Index>(1, first.residual.size()));
    solver_.parameter_tolerance = 1e-6;
    solver_.initial_trust_region_radius = kFirstRadius;
    solver_.logging_type = ceres::SILENT;
    solver_.update_state_every_iteration = true;  // the callback reads the parameters
    Eigen::VectorXd start(static_cast<Eigen::Index>(parameters.size()));
    for (size_t k = 0; k < parameters.size(); ++k)
      start[static_cast<Eigen::Index>(k)] = parameters[k].start;
    cost_ = CostOf(first, parameters, start);
  }

  DescentEnd Run(bool is_near) {
    DescentEnd end;
    UntilAtTurn until_at_turn([this] { return IsAtTurn(); });
    UntilOutOfBudget until_out_of_budget(predictions_, options_.max_predictions);
    solver_.callbacks = {&until_at_turn, &until_out_of_budget};
    bool ended = false;
    for (int round = 0; !ended; ++round) {
      predictions_.FollowSecants(is_near && round < kSecantRounds);
      ceres::Solver::Summary summary;
      solver_.max_num_iterations = options_.max_iterations - end.iterations;
      ceres::Solve(solver_, &problem_, &summary);
      predictions_.FollowSecants(false);
      // Ceres reports no iteration at all if every parameter is held constant at its bound.
      end.iterations += std::max(0, static_cast<int>(summary.iterations.size()) - 1);
      end.usable = summary.termination_type == ceres::CONVERGENCE;
      end.message = end.usable ? "" : summary.message;
      solver_.initial_trust_region_radius = NextRadius(summary);
      const bool has_budget = end.iterations < options_.max_iterations;
      const bool has_failed = summary.termination_type == ceres::FAILURE;
      if (until_out_of_budget.IsUsedUp()) {
        end.is_out_of_budget = true;
        end.usable = false;
        end.message = "the search was ended after " + std::to_string(predictions_.count()) +
                      " predictions, before it had converged";
        break;
      }
      if (has_failed || !has_budget) break;
      ended = !IsWorthARound();
    }
    if (ended) {
      end.usable = true;
      end.message.clear();
    }
    end.parameters = Values(Scaled());
    return end;
  }

 private:
  // φ/typical.
  Eigen::VectorXd Scaled() const {
    Eigen::VectorXd scaled(static_cast<Eigen::Index>(free_.size()));
    for (size_t k = 0; k < free_.size(); ++k)
      scaled[static_cast<Eigen::Index>(k)] = bounds_[k].At(free_[k]).first;
    return scaled;
  }
  Eigen::VectorXd Values(const Eigen::VectorXd& scaled) const {
    Eigen::VectorXd values = scaled;
    for (size_t k = 0; k < free_.size(); ++k) {
      const CalibratedParameter& parameter = parameters_[k];
      double& value = values[static_cast<Eigen::Index>(k)];
      value =
          std::clamp(FromFree(parameter, value * parameter.typical), parameter.min, parameter.max);
    }
    return values;
  }

  // Whether a parameter that Ceres varies is at a turning point.
  bool IsAtTurn() const {
    const Eigen::VectorXd scaled = Scaled();
    for (size_t k = 0; k < free_.size(); ++k)
      if (!problem_.IsParameterBlockConstant(blocks_[k]) &&
          bounds_[k].IsAtTurn(scaled[static_cast<Eigen::Index>(k)]))
        return true;
    return false;
  }

  // Decides after a round whether another one is worthwhile. Ceres stops at a step of little gain,
  // but that step may be short only because earlier ones were rejected or because Broyden updates
  // were misleading; hence the gain of a full Gauss–Newton step is examined here. If the round has
  // gained nothing although such a step predicts a gain, the search ends: the linearisation does
  // not hold in a curved valley. A step that reaches or leaves bounds is taken here, because Ceres
  // can do neither.
  bool IsWorthARound() {
    const Eigen::VectorXd scaled = Scaled(), values = Values(scaled);
    const Prediction& here = predictions_.ExactAt(values);
    if (!here.usable) return false;  // a motion that can be simulated, but not linearised
    const QuadraticCost model = ModelOf(here, parameters_, values);
    const double least_gain = solver_.function_tolerance * cost_;
    const bool has_gained = cost_ - model.cost > least_gain;
    cost_ = model.cost;
    Eigen::VectorXd low = scaled, high = scaled;
    for (Eigen::Index k = 0; k < scaled.size(); ++k) {
      low[k] = std::min(low[k], bounds_[k].low);
      high[k] = std::max(high[k], bounds_[k].high);
    }
    const Eigen::VectorXd step = StepWithin(model, low - scaled, high - scaled);
    if (model.GainOf(step) <= solver_.function_tolerance) return false;
    const auto is_at_bound = [&](const Eigen::VectorXd& at, Eigen::Index k) {
      return at[k] <= low[k] || at[k] >= high[k];
    };
    bool meets_bound = IsAtTurn();
    for (Eigen::Index k = 0; k < scaled.size(); ++k)
      meets_bound = meets_bound || is_at_bound(scaled, k) || is_at_bound(scaled + step, k);
    if (!meets_bound) return has_gained;
    for (const double part : kParts) {
      const Eigen::VectorXd there = (scaled + part * step).cwiseMax(low).cwiseMin(high);
      const Eigen::VectorXd values_there = Values(there);
      const double cost =
          CostOf(predictions_.WithoutJacobianAt(values_there), parameters_, values_there);
      if (!(cost_ - cost > least_gain)) continue;
      cost_ = cost;
      for (Eigen::Index k = 0; k < scaled.size(); ++k) {
        free_[k] = bounds_[k].From(there[k]);
        if (is_at_bound(there, k))
          problem_.SetParameterBlockConstant(blocks_[k]);
        else
          problem_.SetParameterBlockVariable(blocks_[k]);
      }
      return true;
    }
    return has_gained;
  }

  const std::vector<CalibratedParameter>& parameters_;
  const CalibrationOptions& options_;
  SecantPredictions& predictions_;
  std::vector<UnboundedCoordinate> bounds_;
  std::vector<double> free_;  // u
  std::vector<double*> blocks_;
  ceres::Problem problem_;
  ceres::Solver::Options solver_;
  double cost_ = 0;  // cost at the current parameters
};

}  // namespace

DescentEnd Descend(const std::vector<CalibratedParameter>& parameters,
                   const CalibrationOptions& options, const Prediction& first, bool is_near,
                   SecantPredictions* predictions) {
  DescentEnd end = BoundedDescent(parameters, options, first, predictions).Run(is_near);
  SnapToBounds(parameters, predictions, &end.parameters);
  return end;
}

}  // namespace lacuna
