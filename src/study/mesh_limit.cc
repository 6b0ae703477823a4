#include "study/mesh_limit.h"

#include "analysis/linear_evidence.h"
#include "study/linear_misfit.h"
#include "study/nuisance_candidates.h"

namespace lacuna {
namespace {

// What the mesh changes is taken from time steps so many times as long, to find where its limit
// would be fitted; a diagnosis simulates it again from there with the right ones.
constexpr double kLongSteps = 3;
constexpr int kMostStepsToLimit = 4;
constexpr double kAtLimit = 1;  // of ‖r‖², that a step no longer gains

}  // namespace

std::optional<Eigen::VectorXd> AtMeshLimit(const CalibrationProblem& problem,
                                           const Eigen::VectorXd& values, bool fitted_only) {
  const LinearisedMisfit misfit = problem.Linearise(values, true);
  if (!misfit.usable) return std::nullopt;
  const Eigen::VectorXd change = ChangeByMesh(problem, values, kLongSteps);
  if (change.size() != misfit.residual.size()) return std::nullopt;
  const Eigen::MatrixXd by = WhitenedRows(misfit.by, misfit, 0, fitted_only);
  const auto left = [&](const LinearisedMisfit& there) -> Eigen::VectorXd {
    return WhitenedRows(there.residual + change, misfit, 0, fitted_only);
  };
  // The derivatives hardly change on the way: a few steps with the same ones.
  Eigen::VectorXd best = values;
  Eigen::VectorXd here = left(misfit);
  for (int step = 0; step < kMostStepsToLimit; ++step) {
    const LinearFit fit = LinearModel(here, by, PriorsAbout(problem.parameters(), best)).FitAll(1);
    const Eigen::VectorXd moved = MovedBy(problem.parameters(), best, fit.change);
    const LinearisedMisfit there = problem.Linearise(moved, false, {}, &misfit);
    if (!there.usable) break;
    const Eigen::VectorXd next = left(there);
    const double gain = here.squaredNorm() - next.squaredNorm();
    if (!(gain > 0)) break;
    best = moved;
    here = next;
    if (gain < kAtLimit) break;
  }
  problem.SetModel(values);
  return best;
}

}  // namespace lacuna
