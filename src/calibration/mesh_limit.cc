#include "calibration/mesh_limit.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>
#include <vector>

#include "analysis/linear_evidence.h"
#include "calibration/linear_misfit.h"
#include "calibration/other_elements.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/json_file.h"
#include "core/npy.h"

namespace lacuna {
namespace {

using nlohmann::json;

// The files of WriteOtherMesh().
constexpr const char* kDescription = "other_mesh.json";
constexpr const char* kResiduals = "other_mesh.npy";

// A finer mesh has about kFineElements elements, but the ratio of the element volumes is kept
// between these limits. A study with more than kManyElements is compared with a mesh whose elements
// are larger, by the inverse of kLeastVolumeRatio.
constexpr double kFineElements = 2000, kLeastVolumeRatio = 4, kMostVolumeRatio = 12;
constexpr double kManyElements = 6000;
// Beside a clamped edge the error of quadratic elements is proportional to about this power of
// their volume.
constexpr double kVolumePower = 0.7;
// To save time, the parameters are sought with time steps that are longer by this factor, on both
// meshes.
constexpr double kLongSteps = 3;
constexpr int kMostSteps = 4;
// The parameters are first sought with elements whose volume is smaller by kScoutRatio only, where
// the finer mesh has a ratio that is larger by more than kScoutBelow.
constexpr double kScoutRatio = 3, kScoutBelow = 1.5;
// A step that promises to remove less than this share of ‖difference‖², or less than kSettled (σ²),
// is not simulated but added to first order. What the parameters can remove is no longer large then
// beside what remains, and every simulation of the other mesh costs more than several of the
// study's.
constexpr double kLeastReduction = 0.5, kSettled = 1;
constexpr double kShortestStep = 1.0 / 4;  // fraction of a full step

// The ratio of the element volumes: the study's over those of the other mesh. Far from the
// measurements, what another mesh changes is not what it changes in the true motion, so that it is
// not worth the cost of the finest mesh.
double RatioFor(const CalibrationProblem& problem, const LinearisedMisfit& misfit) {
  const double elements = static_cast<double>(problem.body()->ElementCount());
  if (elements > kManyElements) return 1 / kLeastVolumeRatio;
  if (RmsOverSigma(misfit.residual, misfit, /*fitted_only=*/true) > kFarFromTruth)
    return kLeastVolumeRatio;
  return std::clamp(kFineElements / elements, kLeastVolumeRatio, kMostVolumeRatio);
}

// Limits to the change of the parameters by another mesh. Its prior has a standard deviation
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

double OtherMesh::ToLimit() const { return 1 / (1 - std::pow(ratio, -kVolumePower)); }
double OtherMesh::DeviationOfLimit() const {
  constexpr double kLeast = 0.4;
  const double known = IsFiner() ? 1 : 0;
  return std::max(kLeast, std::abs(ToLimit() - known));
}
double OtherMesh::ToRatio(double other_ratio) const {
  return (1 - std::pow(other_ratio, -kVolumePower)) * ToLimit();
}

std::optional<ProblemOnOtherMesh> WithOtherElements(const PredictionStudy& study,
                                                    const TetMesh& own, double ratio) {
  const std::optional<OtherElements> other = MeshWithOtherElements(study, own, ratio);
  if (!other) return std::nullopt;
  try {
    return ProblemOnOtherMesh{std::make_unique<const CalibrationProblem>(study, other->mesh),
                              other->ratio};
  } catch (const InputError&) {
    return std::nullopt;  // for example, a region that holds no node of this mesh
  }
}

namespace {

// Finds the parameters with which another mesh moves like the study's own.
class ChangeSearch {
 public:
  // `own`: the residual of the study's mesh. `on_frame`: LineariseOptions::on_frame of the
  // predictions. All references must outlive this.
  ChangeSearch(const CalibrationProblem& problem, const Eigen::VectorXd& values,
               const LinearisedMisfit& misfit, const Eigen::VectorXd& own,
               const std::function<void()>& on_frame)
      : parameters_(problem.parameters()),
        values_(values),
        misfit_(misfit),
        own_(own),
        on_frame_(on_frame),
        by_(WhitenedRows(misfit.jacobian.leftCols(values.size()), misfit)),
        prior_(PriorOfChange(problem, values)),
        model_(Eigen::VectorXd::Zero(by_.rows()), by_, prior_.priors) {}

  struct Found {
    Eigen::VectorXd change;
    Eigen::VectorXd residual;  // of the other mesh, m; empty: it could not be simulated
  };
  // `known`: the residual of the other mesh after the change `start`; empty: unknown.
  Found Run(const CalibrationProblem& other, Eigen::VectorXd start,
            const Eigen::VectorXd& known = {}) const {
    for (Eigen::Index k = 0; k < start.size(); ++k) {
      const double most = prior_.most[static_cast<size_t>(k)];
      start[k] = std::clamp(start[k], -most, most);
    }
    LinearisedMisfit latest;
    Eigen::VectorXd change = start;
    Tried best = known.size() > 0 ? Compared(known) : At(other, change, &latest);
    if (best.difference.size() == 0) return {change, {}};
    double length = 1;
    for (int step = 0; step < kMostSteps && length >= kShortestStep; ++step) {
      const Eigen::VectorXd& left = best.difference;
      const Eigen::VectorXd way = BestChange(model_, left, by_, change, prior_) - change;
      const double promised = left.squaredNorm() - (left + by_ * way).squaredNorm();
      if (!(promised > std::max(kSettled, kLeastReduction * left.squaredNorm()))) {
        change += way;
        best.residual += misfit_.jacobian.leftCols(way.size()) * way;
        break;
      }
      Tried there = At(other, change + length * way, &latest);
      if (there.difference.size() > 0 && there.difference.squaredNorm() < left.squaredNorm()) {
        change += length * way;
        best = std::move(there);
        length = 1;
      } else {
        length /= 2;
      }
    }
    return {change, std::move(best.residual)};
  }

 private:
  // The difference is whitened; empty where one of the two motions is not available.
  struct Tried {
    Eigen::VectorXd residual, difference;
  };
  Tried At(const CalibrationProblem& other, const Eigen::VectorXd& change,
           LinearisedMisfit* latest) const {
    LinearisedMisfit here = other.Linearise(MovedBy(parameters_, values_, change),
                                            {.near = latest, .on_frame = on_frame_});
    Tried tried = Compared(here.residual);
    if (here.usable) *latest = std::move(here);
    return tried;
  }

  Tried Compared(const Eigen::VectorXd& residual) const {
    Tried tried{residual, {}};
    if (tried.residual.size() == misfit_.residual.size() && own_.size() == tried.residual.size() &&
        tried.residual != own_)
      tried.difference = WhitenedRows(tried.residual - own_, misfit_);
    return tried;
  }

  const std::vector<CalibratedParameter>& parameters_;
  const Eigen::VectorXd& values_;
  const LinearisedMisfit& misfit_;
  const Eigen::VectorXd& own_;
  const std::function<void()>& on_frame_;
  const Eigen::MatrixXd by_;
  const ChangePrior prior_;
  const LinearGaussianModel model_;
};

// Whether two residuals of the study's mesh are those of one motion, but for rounding.
bool IsSame(const Eigen::VectorXd& one, const Eigen::VectorXd& other) {
  constexpr double kRounding = 1e-9;
  return one.size() == other.size() && (one - other).norm() <= kRounding * one.norm();
}

}  // namespace

std::optional<OtherMesh> MakeOtherMesh(const CalibrationProblem& problem,
                                       const Eigen::VectorXd& values,
                                       const LinearisedMisfit& misfit, const OtherMesh* known,
                                       const std::function<void()>& on_frame) {
  const PredictionStudy study = WithLongSteps(problem);
  const TetMesh& own = problem.body()->mesh;
  const double ratio = RatioFor(problem, misfit);
  const auto other = WithOtherElements(study, own, ratio);
  if (!other) return std::nullopt;
  OtherMesh mesh{other->ratio, Eigen::VectorXd::Zero(values.size()), {}, {}};
  mesh.own = CalibrationProblem(study, own)
                 .Linearise(values, {.near = &misfit, .on_frame = on_frame})
                 .residual;
  const ChangeSearch search(problem, values, misfit, mesh.own, on_frame);
  bool is_simulated = false;
  if (known != nullptr) {
    is_simulated = known->ratio == mesh.ratio && IsSame(known->own, mesh.own);
    mesh.change = is_simulated ? known->change : known->ToRatio(mesh.ratio) * known->change;
  } else if (mesh.ratio > kScoutBelow * kScoutRatio) {
    // Most of the way is found with elements that cost little.
    const auto scout = WithOtherElements(study, own, kScoutRatio);
    if (scout && mesh.ratio > kScoutBelow * scout->ratio) {
      const ChangeSearch::Found found = search.Run(*scout->problem, mesh.change);
      if (found.residual.size() > 0) mesh.change = found.change / mesh.ToRatio(scout->ratio);
    }
  }
  ChangeSearch::Found found =
      search.Run(*other->problem, mesh.change, is_simulated ? known->other : Eigen::VectorXd());
  if (found.residual.size() == 0) return std::nullopt;
  mesh.change = std::move(found.change);
  mesh.other = std::move(found.residual);
  return mesh;
}

void WriteOtherMesh(const OtherMesh& mesh, const std::filesystem::path& folder) {
  const json description = {
      {"ratio", mesh.ratio},
      {"change", std::vector<double>(mesh.change.begin(), mesh.change.end())}};
  WriteFileAtomically(folder / kDescription, description.dump(2) + "\n");
  Eigen::MatrixXd residuals(mesh.own.size(), 2);
  residuals << mesh.own, mesh.other;
  WriteNpy(folder / kResiduals, residuals);
}

std::optional<OtherMesh> ReadOtherMesh(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kDescription;
  if (!std::filesystem::exists(file)) return std::nullopt;
  const Eigen::MatrixXd residuals = ReadNpyMatrix(folder / kResiduals);
  if (residuals.cols() != 2)
    throw InputError((folder / kResiduals).string() + ": must have two columns");
  return ReadJsonFile(file, [&](const json& description) {
    const std::vector<double> change = description.at("change");
    return OtherMesh{
        description.at("ratio"),
        Eigen::Map<const Eigen::VectorXd>(change.data(), static_cast<Eigen::Index>(change.size())),
        residuals.col(0), residuals.col(1)};
  });
}

Eigen::VectorXd ResidualAtRatio(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                                const OtherMesh& known, double ratio) {
  const PredictionStudy study = WithLongSteps(problem);
  const auto other = WithOtherElements(study, problem.body()->mesh, ratio);
  if (!other) return {};
  const Eigen::VectorXd change = known.ToRatio(other->ratio) * known.change;
  return other->problem->Linearise(MovedBy(problem.parameters(), values, change)).residual;
}

}  // namespace lacuna
