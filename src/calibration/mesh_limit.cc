#include "calibration/mesh_limit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "analysis/linear_evidence.h"
#include "calibration/linear_misfit.h"
#include "core/error.h"
#include "experiment/reference_body.h"
#include "prediction/predicted_body.h"

namespace lacuna {
namespace {

// The finer mesh has about kFineElements elements, but the ratio of the element volumes is kept
// between these limits.
constexpr double kFineElements = 2000, kLeastVolumeRatio = 4, kMostVolumeRatio = 12;
// Beside a clamped edge the error of quadratic elements is proportional to about this power of
// their volume.
constexpr double kVolumePower = 0.7;
// To save time, the parameters are sought with time steps that are longer by this factor, on both
// meshes.
constexpr double kLongSteps = 3;
constexpr int kMostSteps = 4;
constexpr double kSettled = 1;  // σ², smallest reduction of ‖difference‖² by a step
constexpr double kShortestStep = 1.0 / 4;  // fraction of a full step

// The ratio of the element volumes: as small as a study of the mesh allows.
double RatioFor(const CalibrationProblem& problem) {
  const double elements = static_cast<double>(problem.body()->ElementCount());
  return std::clamp(kFineElements / elements, kLeastVolumeRatio, kMostVolumeRatio);
}

// Limits to the change of the parameters by a finer mesh. Its prior has a standard deviation
// proportional to the parameter's value or to that of its own prior, without which directions that
// the motion does not determine would change arbitrarily. The change is at most `most`, part of the
// distance to the bounds, near which a nearly incompressible body takes too long to simulate.
struct ChangePrior {
  std::vector<LinearPrior> priors;
  std::vector<double> most;
};
ChangePrior PriorOfChange(const CalibrationProblem& problem, const Eigen::VectorXd& values) {
  constexpr double kOfValue = 0.1, kOfPrior = 0.03, kMostOfValue = 0.5, kMostOfRoom = 0.5;
  ChangePrior prior{PriorsAbout(problem.parameters(), values), {}};
  for (size_t k = 0; k < prior.priors.size(); ++k) {
    const CalibratedParameter& parameter = problem.parameters()[k];
    const double value = values[static_cast<Eigen::Index>(k)];
    const double known = prior.priors[k].deviation;
    double about = kOfValue * std::abs(value), most = kMostOfValue * std::abs(value);
    if (!parameter.log_scale) {
      if (std::isfinite(known)) about += kOfPrior * known;
      most = kMostOfRoom * std::min(value - parameter.min, parameter.max - value);
    }
    prior.priors[k] = {0, std::min(known, about), false};
    prior.most.push_back(most);
  }
  return prior;
}

// The change that minimises ‖left + by (change − at)‖² plus the prior's term. Components that would
// exceed their limit are fixed at it. `model` has the Jacobian `by` and any residual.
Eigen::VectorXd BestChange(const LinearGaussianModel& model, const Eigen::VectorXd& left,
                           const Eigen::MatrixXd& by, const Eigen::VectorXd& at,
                           const ChangePrior& prior) {
  // Nonzero for the components that are fixed at their limit.
  Eigen::VectorXd change = Eigen::VectorXd::Zero(at.size());
  std::vector<int> free(prior.priors.size());
  std::iota(free.begin(), free.end(), 0);
  for (;;) {
    const Eigen::VectorXd best =
        model.WithResidual(left + by * (change - at), by).Fit(free, 1).change;
    std::vector<int> within;
    for (size_t k = 0; k < free.size(); ++k) {
      const double here = best[static_cast<Eigen::Index>(k)], most = prior.most[free[k]];
      if (std::abs(here) > most)
        change[free[k]] = std::copysign(most, here);
      else
        within.push_back(free[k]);
    }
    if (within.size() == free.size()) {
      change(free) = best;
      return change;
    }
    free = std::move(within);
  }
}

PredictionStudy WithLongSteps(const CalibrationProblem& problem) {
  PredictionStudy study = problem.WithEstimatedNoise();
  study.time_step *= kLongSteps;
  return study;
}

}  // namespace

double FinerMesh::ToLimit() const { return 1 / (1 - std::pow(ratio, -kVolumePower)); }
double FinerMesh::ToRatio(double other) const {
  return (1 - std::pow(other, -kVolumePower)) * ToLimit();
}

std::unique_ptr<const CalibrationProblem> WithFinerElements(const PredictionStudy& study,
                                                            double ratio) {
  PredictionStudy fine = study;
  fine.mesh.tets.max_volume /= ratio;
  try {
    return std::make_unique<const CalibrationProblem>(study, MakeReferenceBody(fine).mesh);
  } catch (const InputError&) {
    return nullptr;  // a shape that cannot be meshed more finely gives no estimate
  }
}

std::optional<FinerMesh> MakeFinerMesh(const CalibrationProblem& problem,
                                       const Eigen::VectorXd& values,
                                       const LinearisedMisfit& misfit, bool fitted_only) {
  const PredictionStudy study = WithLongSteps(problem);
  FinerMesh finer{RatioFor(problem), Eigen::VectorXd::Zero(values.size()), {}, {}};
  const auto fine_problem = WithFinerElements(study, finer.ratio);
  if (fine_problem == nullptr) return std::nullopt;
  finer.coarse = CalibrationProblem(study, problem.body()->mesh)
                     .Linearise(values, false, {}, nullptr, &misfit)
                     .residual;
  // The difference is whitened; empty where one of the two motions is not available.
  struct Tried {
    Eigen::VectorXd fine, difference;
  };
  LinearisedMisfit latest;
  const auto at = [&](const Eigen::VectorXd& change) {
    LinearisedMisfit here = fine_problem->Linearise(MovedBy(problem.parameters(), values, change),
                                                    false, {}, nullptr, &latest);
    Tried tried{here.residual, {}};
    if (here.usable) latest = std::move(here);
    if (tried.fine.size() == misfit.residual.size() && finer.coarse.size() == tried.fine.size() &&
        tried.fine != finer.coarse)
      tried.difference = WhitenedRows(tried.fine - finer.coarse, misfit, 0, fitted_only);
    return tried;
  };
  const Eigen::MatrixXd by =
      WhitenedRows(misfit.jacobian.leftCols(values.size()), misfit, 0, fitted_only);
  const ChangePrior prior = PriorOfChange(problem, values);
  Tried best = at(finer.change);
  if (best.difference.size() == 0) return std::nullopt;
  const LinearGaussianModel model(Eigen::VectorXd::Zero(by.rows()), by, prior.priors);
  double length = 1;
  for (int step = 0; step < kMostSteps && length >= kShortestStep; ++step) {
    const Eigen::VectorXd& left = best.difference;
    const Eigen::VectorXd way = BestChange(model, left, by, finer.change, prior) - finer.change;
    const double promised = left.squaredNorm() - (left + by * way).squaredNorm();
    if (!(promised > kSettled)) break;
    Tried there = at(finer.change + length * way);
    if (there.difference.size() > 0 && there.difference.squaredNorm() < left.squaredNorm()) {
      finer.change += length * way;
      best = std::move(there);
      length = 1;
    } else {
      length /= 2;
    }
  }
  finer.fine = std::move(best.fine);
  return finer;
}

Eigen::VectorXd ResidualAtRatio(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                                const FinerMesh& finer, double ratio) {
  const PredictionStudy study = WithLongSteps(problem);
  const auto other = WithFinerElements(study, ratio);
  if (other == nullptr) return {};
  const Eigen::VectorXd change = finer.ToRatio(ratio) * finer.change;
  return other->Linearise(MovedBy(problem.parameters(), values, change), false).residual;
}

std::optional<Eigen::VectorXd> AtMeshLimit(const CalibrationProblem& problem,
                                           const Eigen::VectorXd& values) {
  const LinearisedMisfit misfit = problem.Linearise(values, true);
  if (!misfit.usable) return std::nullopt;
  const std::optional<FinerMesh> finer =
      MakeFinerMesh(problem, values, misfit, /*fitted_only=*/true);
  if (!finer) return std::nullopt;
  return MovedBy(problem.parameters(), values, finer->ToLimit() * finer->change);
}

}  // namespace lacuna
