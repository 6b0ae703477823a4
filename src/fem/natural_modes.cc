#include "fem/natural_modes.h"

#include <glog/logging.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "fem/cholmod_factor.h"
#include "fem/elimination_order.h"
#include "fem/held_components.h"
#include "fem/step_equation.h"

namespace lacuna {
namespace {

// The shift as a share of trace K / trace M, which is about the square of the highest frequency.
constexpr double kShift = 1e-7;
constexpr int kMostIterations = 300;
// Frequencies are accepted where all wanted eigenvalues change by less than this share.
constexpr double kTolerance = 1e-10;
// The subspace has this many columns more than wanted modes. Larger values make the iteration
// converge faster, but each iteration costs more.
constexpr int kFurtherColumns = 8;

// Masses of the components; those that are held have none.
Eigen::VectorXd FreeMasses(const Body& body, const HeldComponents& held) {
  Eigen::VectorXd masses(3 * body.NodeCount());
  for (int node = 0; node < body.NodeCount(); ++node)
    masses.segment<3>(3 * node).setConstant(body.node_mass[node]);
  held.ClearIn(masses);
  return masses;
}

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

}  // namespace

NaturalModes FindNaturalModes(const Model& model, const Eigen::VectorXd& position, int count) {
  HeldComponents held(HeldAxes(model));
  const Eigen::VectorXd masses = FreeMasses(*model.body, held);
  const Eigen::Index free_components = (masses.array() > 0).count();
  CHECK_GT(free_components, count);
  const Eigen::Index columns = std::min<Eigen::Index>(free_components, 2 * count + kFurtherColumns);

  const BlockMatrix stiffness = StiffnessAt(model, position);
  double trace = 0;
  for (const int k : stiffness.pattern().diagonal) trace += stiffness.Block(k).trace();
  const double shift = kShift * trace / masses.sum();
  BlockMatrix shifted = stiffness;
  for (int node = 0; node < model.body->NodeCount(); ++node)
    shifted.Block(shifted.pattern().diagonal[static_cast<size_t>(node)]).diagonal().array() +=
        shift * model.body->node_mass[node];
  const EliminationOrder order = NestedDissection(*model.body->pattern, held.whole_nodes());
  CholmodFactor factor(*model.body->pattern, order);
  NaturalModes modes;
  if (!factor.Factorise(held.Decoupled(shifted))) {
    modes.message = "the stiffness is not positive semi-definite";
    return modes;
  }

  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::MatrixXd basis =
      Eigen::MatrixXd::NullaryExpr(masses.size(), columns, [&] { return uniform(random); });
  Eigen::VectorXd last = Eigen::VectorXd::Zero(count);
  for (modes.iterations = 1; modes.iterations <= kMostIterations; ++modes.iterations) {
    basis = SolveFree(factor, order, held, masses.asDiagonal() * basis);
    const Eigen::MatrixXd mass = basis.transpose() * masses.asDiagonal() * basis;
    const Eigen::MatrixXd projected = basis.transpose() * (shifted * basis);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> ritz(
        0.5 * (projected + projected.transpose()), 0.5 * (mass + mass.transpose()));
    if (ritz.info() != Eigen::Success) {
      modes.message = "the subspace has become linearly dependent";
      return modes;
    }
    basis = basis * ritz.eigenvectors();
    const Eigen::VectorXd squares = ritz.eigenvalues().head(count);
    const bool is_found = ((squares - last).array().abs() <= kTolerance * squares.array()).all();
    last = squares;
    if (!is_found) continue;
    modes.frequencies = (squares.array() - shift).max(0).sqrt().matrix() / (2 * std::numbers::pi);
    modes.shapes = basis.leftCols(count);
    return modes;
  }
  modes.message = "the subspace iteration did not converge";
  return modes;
}

}  // namespace lacuna
