#include "fem/reduced_response.h"

#include <glog/logging.h>

#include <Eigen/Dense>
#include <algorithm>
#include <optional>

#include "fem/free_component_factor.h"
#include "fem/held_components.h"
#include "fem/prediction.h"
#include "geometry/hermite.h"

namespace lacuna {
namespace {

// Shapes whose eigenvalue of the Gram matrix is below this fraction of the largest one are linear
// combinations of the others up to rounding.
constexpr double kDependent = 1e-11;

// M times the columns.
Eigen::MatrixXd Massed(const Body& body, const Eigen::MatrixXd& columns) {
  Eigen::MatrixXd product = columns;
  for (Eigen::Index i = 0; i < body.node_mass.size(); ++i)
    product.middleRows<3>(3 * i) *= body.node_mass[i];
  return product;
}

// Tangents of the effects at states of a trajectory, and solutions with them.
class TangentsAlong {
 public:
  TangentsAlong(const Model& model, const ReducedResponseOptions& options)
      : model_(model),
        time_step_(options.time_step),
        has_inertia_(options.scheme != TimeScheme::kQuasiStatic),
        factor_(*model.body->pattern, HeldComponents(HeldAxes(model))),
        matrix_(model.body->pattern) {}

  // The negative weighted derivative of the effects at a state, times the columns.
  Eigen::MatrixXd Apply(const TrajectoryState& state, const TangentWeights& weights,
                        const Eigen::MatrixXd& columns) {
    Assemble(state, weights, false);
    return matrix_ * columns;
  }

  // [K⁻¹ right, K⁻¹ M K⁻¹ right] on the free nodes, with the convexified K if K is not definite. No
  // value if that fails too.
  std::optional<Eigen::MatrixXd> Compliance(const TrajectoryState& state,
                                            const Eigen::MatrixXd& right, const Body& body) {
    bool factorised = false;
    for (const bool convexify : {false, true}) {
      Assemble(state, {.position = 1}, convexify);
      if ((factorised = factor_.Factorise(matrix_))) break;
    }
    if (!factorised) return std::nullopt;
    const Eigen::MatrixXd first = factor_.Solve(right);
    Eigen::MatrixXd both(right.rows(), 2 * right.cols());
    both << first, factor_.Solve(Massed(body, first));
    return both;
  }

 private:
  void Assemble(const TrajectoryState& state, const TangentWeights& weights, bool convexify) {
    const Eigen::VectorXd no_acceleration = Eigen::VectorXd::Zero(state.position.size());
    const TangentWeights negative{-weights.position, -weights.velocity, -weights.acceleration};
    matrix_.SetZero();
    for (size_t j = 0; j < model_.effects.size(); ++j)
      model_.effects[j]->AddTangents({.body = *model_.body,
                                      .position = state.position,
                                      .velocity = state.velocity,
                                      .acceleration = no_acceleration,
                                      .time = state.time,
                                      .time_step = time_step_,
                                      .state = state.effect_state[j],
                                      .elasticity = ElasticityOf(model_),
                                      .has_inertia = has_inertia_},
                                     negative, convexify, &matrix_);
  }

  const Model& model_;
  double time_step_;
  bool has_inertia_;
  FreeComponentFactor factor_;
  BlockMatrix matrix_;
};

// The principal shapes of the normalised columns, orthonormal with respect to M.
Eigen::MatrixXd PrincipalShapes(const Body& body, Eigen::MatrixXd columns, int most) {
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    const double norm = std::sqrt(columns.col(k).dot(Massed(body, columns.col(k)).col(0)));
    if (norm > 0) columns.col(k) /= norm;
  }
  const Eigen::MatrixXd gram = columns.transpose() * Massed(body, columns);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gram);
  const Eigen::Index count = gram.rows();
  Eigen::Index kept = 0;
  while (kept < std::min<Eigen::Index>(count, most) &&
         eigen.eigenvalues()[count - 1 - kept] > kDependent * eigen.eigenvalues()[count - 1])
    ++kept;
  return columns * eigen.eigenvectors().rightCols(kept) *
         eigen.eigenvalues().tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
}

}  // namespace

ReducedResponse::ReducedResponse(const Model& model, const std::vector<TrajectoryState>& states,
                                 const Eigen::MatrixXd& shapes,
                                 const ReducedResponseOptions& options)
    : options_(options) {
  CHECK(!states.empty());
  const Body& body = *model.body;
  TangentsAlong along(model, options);

  std::vector<Eigen::MatrixXd> answers;
  const size_t wanted = std::min<size_t>(options.basis_states, states.size());
  for (size_t k = 0; k < wanted; ++k) {
    const size_t at = wanted > 1 ? k * (states.size() - 1) / (wanted - 1) : 0;
    if (auto answer = along.Compliance(states[at], shapes, body))
      answers.push_back(std::move(*answer));
  }
  if (answers.empty()) {
    message_ = "the model's stiffness is not positive definite at any of the states";
    return;
  }
  Eigen::MatrixXd all(shapes.rows(), 0);
  for (const Eigen::MatrixXd& answer : answers) {
    all.conservativeResize(Eigen::NoChange, all.cols() + answer.cols());
    all.rightCols(answer.cols()) = answer;
  }
  basis_ = PrincipalShapes(body, std::move(all), options.most_shapes);
  load_ = basis_.transpose() * shapes;
  const Eigen::MatrixXd mass = basis_.transpose() * Massed(body, basis_);
  for (const TrajectoryState& state : states) {
    const auto reduced = [&](const TangentWeights& weights) -> Eigen::MatrixXd {
      return basis_.transpose() * along.Apply(state, weights, basis_);
    };
    tangents_.push_back({state.time, mass + reduced({.acceleration = 1}), reduced({.velocity = 1}),
                         reduced({.position = 1})});
  }
}

ReducedResponse::Tangents ReducedResponse::At(double time) const {
  const auto after = std::find_if(tangents_.begin(), tangents_.end(),
                                  [&](const Tangents& tangents) { return tangents.time >= time; });
  if (after == tangents_.end()) return tangents_.back();
  if (after == tangents_.begin()) return tangents_.front();
  const Tangents& before = *(after - 1);
  const double t = (time - before.time) / (after->time - before.time);
  return {time, (1 - t) * before.mass + t * after->mass,
          (1 - t) * before.damping + t * after->damping,
          (1 - t) * before.stiffness + t * after->stiffness};
}

void ReducedResponse::Respond(
    const Eigen::MatrixXd& held, const ForceHistories& histories, const std::vector<double>& times,
    const std::function<void(int index, const Eigen::MatrixXd& position,
                             const Eigen::MatrixXd& velocity)>& visit) const {
  CHECK(IsUsable()) << message_;
  double time = tangents_.front().time;
  Eigen::MatrixXd q = tangents_.front().stiffness.partialPivLu().solve(load_ * held);
  Eigen::MatrixXd w = Eigen::MatrixXd::Zero(q.rows(), q.cols()), a = w;
  Eigen::MatrixXd q_before, w_before, a_before;
  size_t next = 0;
  for (; next < times.size() && times[next] <= time; ++next) visit(static_cast<int>(next), q, w);
  double last = 0;
  const double inertia = options_.scheme == TimeScheme::kQuasiStatic ? 0 : 1;
  for (int step = 0; next < times.size(); ++step) {
    const auto [h, end] = NextStep(options_.scheme, options_.time_step, step, time, times[next]);
    const SchemeWeights weights = WeightsOf(options_.scheme, h, step, last);
    const double rate = weights.rate;
    const Eigen::MatrixXd q_history = weights.Combine(q, q_before, w, w_before);
    const Eigen::MatrixXd w_history = weights.Combine(w, w_before, a, a_before);
    time = end;
    last = h;
    const Tangents at = At(time);
    const Eigen::MatrixXd right = load_ * histories(time) +
                                  inertia * at.mass * (rate * rate * q_history + rate * w_history) +
                                  at.damping * (rate * q_history);
    q_before = std::move(q);
    w_before = std::move(w);
    a_before = std::move(a);
    q = (inertia * rate * rate * at.mass + rate * at.damping + at.stiffness)
            .partialPivLu()
            .solve(right);
    w = rate * (q - q_history);
    a = rate * (w - w_history);
    for (; next < times.size() && times[next] <= time; ++next) {
      const Knot<Eigen::MatrixXd> at_time = Interpolate(Knot<Eigen::MatrixXd>{q_before, w_before},
                                                        {q, w}, h, 1 - (time - times[next]) / h);
      visit(static_cast<int>(next), at_time.position, at_time.velocity);
    }
  }
}

}  // namespace lacuna
