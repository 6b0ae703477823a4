#include "study/mesh_limit.h"

#include "analysis/linear_evidence.h"
#include "study/linear_misfit.h"
#include "study/nuisance_candidates.h"

namespace lacuna {
namespace {

// What the mesh changes is taken from time steps so many times as long, to find where its limit
// would be fitted; a diagnosis simulates it again from there with the right ones.
constexpr double kLongSteps = 3;
constexpr int kMostStepsToLimit = 8;
constexpr double kAtLimit = 1;              // of ‖r‖², that a step no longer gains
constexpr double kShortestStep = 1.0 / 16;  // of a whole one

}  // namespace

std::optional<Eigen::VectorXd> AtMeshLimit(const CalibrationProblem& problem,
                                           const Eigen::VectorXd& values, bool fitted_only) {
  const LinearisedMisfit misfit = problem.Linearise(values, true);
  if (!misfit.usable) return std::nullopt;
  const Eigen::VectorXd change = ChangeByMesh(problem, values, kLongSteps);
  if (change.size() != misfit.residual.size()) return std::nullopt;
  Eigen::MatrixXd by = WhitenedRows(misfit.by, misfit, 0, fitted_only);
  const auto left = [&](const LinearisedMisfit& there) -> Eigen::VectorXd {
    return WhitenedRows(there.residual + change, misfit, 0, fitted_only);
  };
  std::optional<Eigen::VectorXd> limit = values;
  Eigen::VectorXd here = left(misfit);
  for (int step = 0; step < kMostStepsToLimit; ++step) {
    const LinearFit fit =
        LinearModel(here, by, PriorsAbout(problem.parameters(), *limit)).FitAll(1);
    double gain = 0, length = 1;
    for (; length >= kShortestStep; length /= 2) {
      const Eigen::VectorXd moved = MovedBy(problem.parameters(), *limit, length * fit.change);
      const LinearisedMisfit there = problem.Linearise(moved, false, {}, &misfit);
      if (!there.usable) continue;
      const Eigen::VectorXd next = left(there);
      gain = here.squaredNorm() - next.squaredNorm();
      if (!(gain > 0)) continue;
      limit = moved;
      here = next;
      break;
    }
    if (!(gain > kAtLimit)) {
      const double promised = here.squaredNorm() - (here + by * fit.change).squaredNorm();
      if (step == 0 && !(gain > 0) && promised > kAtLimit) limit.reset();
      break;
    }
    // The derivatives hardly change on a short way; where a step had to be cut, they do.
    if (length == 1) continue;
    const LinearisedMisfit there = problem.Linearise(*limit, true, {}, &misfit);
    if (!there.usable) break;
    by = WhitenedRows(there.by, misfit, 0, fitted_only);
  }
  problem.SetModel(values);
  return limit;
}

}  // namespace lacuna
