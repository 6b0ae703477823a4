#include "fem/tangent_solver.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace lacuna {

TangentSolver::TangentSolver(const BlockPattern& pattern, HeldComponents held, double tolerance)
    : factor_(pattern, std::move(held)), tolerance_(tolerance) {}

bool TangentSolver::AddSolution(const TangentSystem& system, Eigen::MatrixXd* sum) {
  const Eigen::Index columns = system.right.cols();
  std::vector<char> solved(
      static_cast<size_t>((columns + ColumnGroup::kSize - 1) / ColumnGroup::kSize), 0);
  const auto is_solved = [&] { return std::count(solved.begin(), solved.end(), 0) == 0; };
  const auto for_unsolved = [&](const auto& solve) {
    ForEachGroup(columns, [&](const ColumnGroup& group) {
      char& is_done = solved[static_cast<size_t>(group.first / ColumnGroup::kSize)];
      if (is_done) return;
      const std::optional<Eigen::MatrixXd> solution = solve(group);
      if (!solution) return;
      group.Of(*sum) += *solution;
      is_done = 1;
    });
  };
  if (factor_.Factorise(system.tangent))
    for_unsolved([&](const ColumnGroup& group) { return SolveByTangent(system, group); });
  if (is_solved()) return true;
  if (factor_.Factorise(system.approximation()))
    for_unsolved([&](const ColumnGroup& group) { return SolveByApproximation(system, group); });
  if (is_solved()) return true;
  const UnsymmetricFactor whole(held(), system.tangent, system.skew);
  if (whole.IsUsable())
    for_unsolved([&](const ColumnGroup& group) { return SolveByWhole(whole, system, group); });
  return is_solved();
}

std::optional<Eigen::MatrixXd> TangentSolver::SolveByTangent(const TangentSystem& system,
                                                             const ColumnGroup& group) const {
  Eigen::MatrixXd wanted = group.Of(system.right);
  if (system.skew == nullptr) return factor_.Solve(wanted);
  held().ClearIn(wanted);
  const BlockMatrix& skew = *system.skew;
  // The contribution of the skew part changes little from one step to the next.
  Eigen::MatrixXd expected = system.expected(group);
  return Refine(wanted, wanted - skew * expected,
                [&](const Eigen::MatrixXd& step, Eigen::MatrixXd* residual) {
                  *residual = skew * (expected - step);
                  expected.setZero();
                });
}

std::optional<Eigen::MatrixXd> TangentSolver::SolveByApproximation(const TangentSystem& system,
                                                                   const ColumnGroup& group) const {
  Eigen::MatrixXd wanted = group.Of(system.right);
  held().ClearIn(wanted);
  return Refine(wanted, wanted, [&](const Eigen::MatrixXd& step, Eigen::MatrixXd* residual) {
    *residual -= system.tangent * step;
    if (system.skew != nullptr) *residual -= *system.skew * step;
  });
}

std::optional<Eigen::MatrixXd> TangentSolver::SolveByWhole(const UnsymmetricFactor& whole,
                                                           const TangentSystem& system,
                                                           const ColumnGroup& group) const {
  Eigen::MatrixXd wanted = group.Of(system.right);
  held().ClearIn(wanted);
  const Eigen::MatrixXd solution = whole.Solve(wanted);
  Eigen::MatrixXd residual = wanted - system.tangent * solution;
  if (system.skew != nullptr) residual -= *system.skew * solution;
  held().ClearIn(residual);
  const Eigen::RowVectorXd small = tolerance_ * wanted.colwise().norm();
  if ((residual.colwise().norm().array() <= small.array()).all()) return solution;
  return std::nullopt;
}

// Iterative refinement: adds solutions for the residual until it is small relative to the
// right-hand side. update(step, &residual) computes the residual after a step.
template <typename Update>
std::optional<Eigen::MatrixXd> TangentSolver::Refine(const Eigen::MatrixXd& wanted,
                                                     Eigen::MatrixXd residual,
                                                     const Update& update) const {
  constexpr int kMaxIterations = 60;
  const Eigen::RowVectorXd small = tolerance_ * wanted.colwise().norm();
  Eigen::MatrixXd solution = Eigen::MatrixXd::Zero(wanted.rows(), wanted.cols());
  held().ClearIn(residual);
  double last = residual.norm();
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const Eigen::MatrixXd step = factor_.Solve(residual);
    solution += step;
    update(step, &residual);
    held().ClearIn(residual);
    if ((residual.colwise().norm().array() <= small.array()).all()) return solution;
    if (!(residual.norm() < 2 * last)) break;
    last = residual.norm();
  }
  return std::nullopt;
}

}  // namespace lacuna
