#include "fem/kept_factor_iteration.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "fem/node_rotations.h"

namespace lacuna {
namespace {

constexpr int kMostChordSteps = 16;
// The largest ratio of a new residual to the old one, with an old factor and with a new one. Larger
// values renew the factor less often and take more iterations.
constexpr double kSufficientFall = 0.5, kTolerableFall = 0.9;
// The number of steps after which the rate of convergence is known.
constexpr int kStepsToJudge = 2;

// Steps −M⁻¹ r with a fixed factor M of a tangent, each combined with the earlier ones so that the
// residual becomes smallest to first order, in the norm of M⁻¹.
class ChordSteps {
 public:
  // The step from an iterate with residual r, where `image` is M⁻¹ r. The iterate is that to which
  // the step before has led.
  Eigen::VectorXd Next(const Eigen::VectorXd& residual, const Eigen::VectorXd& image) {
    if (steps_.empty()) {
      first_residual_ = residual.norm();
    } else {
      changes_.push_back(residual - residual_);
      images_.push_back(image - image_);
    }
    residual_ = residual;
    image_ = image;
    // Minimises ‖r − Σ γ Δr‖, and steps by −M⁻¹ (r − Σ γ Δr) − Σ γ Δx.
    const Eigen::Index count = static_cast<Eigen::Index>(steps_.size());
    Eigen::MatrixXd products(count, count);
    Eigen::VectorXd right(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j)
        products(i, j) = products(j, i) = images_[i].dot(changes_[j]);
      right[i] = images_[i].dot(residual);
    }
    const Eigen::VectorXd weight = products.ldlt().solve(right);
    Eigen::VectorXd step = -image;
    for (Eigen::Index i = 0; i < count; ++i) step += weight[i] * (images_[i] - steps_[i]);
    steps_.push_back(step);
    return step;
  }

  int Count() const { return static_cast<int>(steps_.size()); }
  double FirstResidual() const { return first_residual_; }

 private:
  std::vector<Eigen::VectorXd> steps_, changes_, images_;  // of the position, of r, and of M⁻¹ r
  Eigen::VectorXd residual_, image_;
  double first_residual_ = 0;
};

bool IsRenewalCheaper(const NewtonProblem& problem, const LinearSolver& solver,
                      const ChordSteps& steps, const NewtonIterate& at) {
  return steps.Count() >= kStepsToJudge &&
         solver.IsRenewalCheaper(steps.Count(), steps.FirstResidual(), at.residual.norm(),
                                 problem.relative_tolerance * at.force_scale);
}

}  // namespace

std::optional<NewtonIterate> IterateWithKeptFactor(const NewtonProblem& problem,
                                                   const Eigen::VectorXd& target,
                                                   const Eigen::VectorXd& start,
                                                   LinearSolver* solver, BlockMatrix* tangent,
                                                   int* iterations) {
  if (!problem.equation.has_inertia() || !solver->KeepsFactors()) return std::nullopt;
  NewtonIterate at = EvaluateIterate(problem, WithHeldAt(problem, target, start));
  if (!at.residual.allFinite()) return std::nullopt;
  std::vector<Eigen::Matrix3d> rotations;  // of the nodes, where the factor was last used or made
  if (solver->HasFactor()) rotations = NodeRotations(problem.equation.body(), at.position);
  ChordSteps steps;
  bool is_new = false;
  for (int iteration = 0; !IsWithinTolerance(problem, at); ++iteration) {
    if (iteration == std::min(kMostChordSteps, problem.max_iterations)) return std::nullopt;
    ++*iterations;
    if (!is_new && (!solver->HasFactor() || IsRenewalCheaper(problem, *solver, steps, at))) {
      problem.equation.Tangent(at.position, /*convexify=*/false, tangent);
      rotations = NodeRotations(problem.equation.body(), at.position);
      if (!solver->Factorise(*tangent, rotations)) return std::nullopt;
      is_new = true;
      steps = {};
    }
    Eigen::VectorXd image;
    solver->ApplyFactor(at.residual, rotations, &image);
    NewtonIterate next = EvaluateIterate(problem, at.position + steps.Next(at.residual, image));
    const double ratio = next.residual.norm() / at.residual.norm();
    if (ratio <= (is_new ? kTolerableFall : kSufficientFall)) {
      at = std::move(next);
    } else if (is_new) {
      return std::nullopt;
    } else {
      solver->DropFactor();
    }
  }
  if (steps.Count() > 0) solver->CountApplications(steps.Count());
  return at;
}

}  // namespace lacuna
