#include "fem/natural_modes.h"

#include <glog/logging.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "fem/free_component_factor.h"
#include "fem/held_components.h"
#include "fem/step_equation.h"

namespace lacuna {
namespace {

// The shift σ as a share of trace K / trace M, which is about the square of the highest angular
// frequency.
constexpr double kShift = 1e-7;
constexpr int kMostIterations = 300;
// Frequencies are accepted where all wanted eigenvalues change by less than this share.
constexpr double kTolerance = 1e-10;
// The subspace has this many columns more than wanted modes. Larger values make the iteration
// converge faster, but each iteration costs more.
constexpr int kFurtherColumns = 8;

// The masses of the components, kg; 0 for those that are held.
Eigen::VectorXd FreeMasses(const Body& body, const HeldComponents& held) {
  Eigen::VectorXd masses(3 * body.NodeCount());
  for (int node = 0; node < body.NodeCount(); ++node)
    masses.segment<3>(3 * node).setConstant(body.node_mass[node]);
  held.ClearIn(masses);
  return masses;
}

// K at a position, N/m.
BlockMatrix StiffnessAt(const Model& model, const Eigen::VectorXd& position) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(position.size());
  const MotionHistory rest = RestHistory(model);
  BlockMatrix stiffness(model.body->pattern);
  for (size_t j = 0; j < model.effects.size(); ++j)
    model.effects[j]->AddTangents({.body = *model.body,
                                   .position = position,
                                   .velocity = zero,
                                   .acceleration = zero,
                                   .state = rest.effect_state[j],
                                   .elasticity = ElasticityOf(model)},
                                  {.position = -1}, false, &stiffness);
  return stiffness;
}

// The eigenvalue problem (K + σM) φ = (ω² + σ) M φ.
struct ShiftedProblem {
  Eigen::VectorXd masses;  // of the components, kg; 0 where they are held
  double shift = 0;        // σ, 1/s²
  BlockMatrix stiffness;   // K + σM, N/m
};

ShiftedProblem MakeShiftedProblem(const Model& model, const Eigen::VectorXd& position,
                                  const Eigen::VectorXd& masses) {
  BlockMatrix stiffness = StiffnessAt(model, position);
  const std::vector<int>& diagonal = stiffness.pattern().diagonal;
  double trace = 0;
  for (const int k : diagonal) trace += stiffness.Block(k).trace();
  const double shift = kShift * trace / masses.sum();
  for (int node = 0; node < model.body->NodeCount(); ++node)
    stiffness.Block(diagonal[static_cast<size_t>(node)]).diagonal().array() +=
        shift * model.body->node_mass[node];
  return {masses, shift, std::move(stiffness)};
}

Eigen::MatrixXd RandomBasis(Eigen::Index rows, Eigen::Index columns) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return uniform(random); });
}

// The Ritz values in the span of the columns of `basis`, ascending, 1/s². The columns become the
// Ritz vectors, φᵀMφ = I. No value where they have become linearly dependent.
std::optional<Eigen::VectorXd> RayleighRitz(const ShiftedProblem& problem, Eigen::MatrixXd* basis) {
  const Eigen::MatrixXd mass = basis->transpose() * problem.masses.asDiagonal() * *basis;
  const Eigen::MatrixXd projected = basis->transpose() * (problem.stiffness * *basis);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> ritz(
      0.5 * (projected + projected.transpose()), 0.5 * (mass + mass.transpose()));
  if (ritz.info() != Eigen::Success) return std::nullopt;
  *basis = *basis * ritz.eigenvectors();
  return ritz.eigenvalues();
}

// The `count` lowest modes by iteration of a subspace of `columns` dimensions, with the factor of
// K + σM.
NaturalModes IterateSubspace(const ShiftedProblem& problem, const FreeComponentFactor& factor,
                             int count, Eigen::Index columns) {
  NaturalModes modes;
  Eigen::MatrixXd basis = RandomBasis(problem.masses.size(), columns);
  Eigen::VectorXd last = Eigen::VectorXd::Zero(count);
  for (modes.iterations = 1; modes.iterations <= kMostIterations; ++modes.iterations) {
    basis = factor.Solve(problem.masses.asDiagonal() * basis);
    const std::optional<Eigen::VectorXd> values = RayleighRitz(problem, &basis);
    if (!values) {
      modes.message = "the subspace has become linearly dependent";
      return modes;
    }
    const Eigen::VectorXd squares = values->head(count);
    const bool is_found = ((squares - last).array().abs() <= kTolerance * squares.array()).all();
    last = squares;
    if (!is_found) continue;
    modes.frequencies =
        (squares.array() - problem.shift).max(0).sqrt().matrix() / (2 * std::numbers::pi);
    modes.shapes = basis.leftCols(count);
    return modes;
  }
  modes.message = "the subspace iteration did not converge";
  return modes;
}

}  // namespace

NaturalModes FindNaturalModes(const Model& model, const Eigen::VectorXd& position, int count) {
  const HeldComponents held(HeldAxes(model));
  const Eigen::VectorXd masses = FreeMasses(*model.body, held);
  const Eigen::Index free_components = (masses.array() > 0).count();
  CHECK_GT(free_components, count);
  const Eigen::Index columns = std::min<Eigen::Index>(free_components, 2 * count + kFurtherColumns);
  const ShiftedProblem problem = MakeShiftedProblem(model, position, masses);
  FreeComponentFactor factor(*model.body->pattern, held);
  if (!factor.Factorise(problem.stiffness)) {
    NaturalModes none;
    none.message = "the stiffness is not positive semi-definite";
    return none;
  }
  return IterateSubspace(problem, factor, count, columns);
}

}  // namespace lacuna
