#include "diagnosis/unknown_force.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibration/linear_misfit.h"
#include "core/parallel.h"
#include "prediction/observed_response.h"
#include "prediction/replayed_motion.h"
#include "prediction/smooth_force.h"

namespace lacuna {
namespace {

// The force may change within two frames, but in no more steps than this. More: faster changes in
// long recordings, and a larger eigenvalue problem.
constexpr int kMostKnots = 40;
constexpr double kPersistence = 2;  // τ, in knots
// Components of the response that are kept for each recording; those that follow change the
// measurements by less than the share kLeastVisible of the noise where the amplitudes have the
// standard deviation kStrongForce, about the acceleration of gravity: a model that lacks more than
// the weight of the object fails in ways that need no such test.
constexpr Eigen::Index kMostComponents = 40;
constexpr double kStrongForce = 10;  // m/s²
constexpr double kLeastVisible = 0.1;

// The combinations of the columns of one recording, in all rows of the misfit, that could be seen.
Eigen::MatrixXd VisibleComponents(const Eigen::MatrixXd& columns, const LinearisedMisfit& misfit) {
  const Eigen::MatrixXd white = WhitenedRows(columns, misfit);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      Eigen::MatrixXd(white.transpose() * white));
  const double least = std::pow(kLeastVisible / kStrongForce, 2);
  const Eigen::Index visible =
      std::min<Eigen::Index>(kMostComponents, (eigen.eigenvalues().array() > least).count());
  return columns * eigen.eigenvectors().rightCols(visible);
}

// One recording: its columns, in all rows of the misfit, or why it has none.
struct RecordedForce {
  Eigen::MatrixXd columns;
  std::string untried;
};

// `part`: the points of the recording.
RecordedForce ForceIn(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                      const LinearisedMisfit& misfit, const LinearisedMisfit::Part& part) {
  const auto untried = [&](const std::string& why) {
    return RecordedForce{Eigen::MatrixXd(misfit.residual.size(), 0),
                         problem.models()[part.recording].recording().name + ": " + why};
  };
  const RecordingModel recording = problem.ModelAt(part.recording, values);
  const ReplayedMotion motion = Replay(recording, problem.NuisanceOf(part.recording, values));
  if (!motion.summary.IsUsable())
    return untried("the fitted motion could not be predicted again (" + motion.summary.message +
                   ")");
  const std::optional<SmoothForce> field = SmoothForceDuring(recording, motion, kMostKnots);
  if (!field) return untried("there are too few frames after the start of the motion");
  const PredictionOptions options = recording.Options(motion.nuisance);
  const ReducedResponse response(recording.model(), motion.states, field->Shapes(),
                                 {.scheme = options.step.scheme, .time_step = options.time_step});
  if (!response.IsUsable()) return untried(response.message());
  const ForceHistories hat_functions = [&](double time) { return field->HatFunctions(time); };
  std::vector<int> frames(part.observed.size());
  std::iota(frames.begin(), frames.end(), 0);
  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(misfit.residual.size(), field->amplitudes.size());
  own.middleRows(part.first_row, part.layout.Rows()) =
      ObservedResponse(recording, motion, response, hat_functions(field->start), hat_functions,
                       frames, part.observed) *
      PersistentPriorRoot(field->KnotCount(), kPersistence);
  RecordedForce force{VisibleComponents(own, misfit), ""};
  return force.columns.cols() > 0 ? force : untried("no such force would be seen");
}

}  // namespace

UnknownForce UnknownForceColumns(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                                 const LinearisedMisfit& misfit) {
  // One part for each recording; the load cells have parts of their own, without points.
  std::vector<const LinearisedMisfit::Part*> of_points;
  for (const LinearisedMisfit::Part& part : misfit.parts)
    if (part.IsOfPoints()) of_points.push_back(&part);
  std::vector<RecordedForce> recorded(of_points.size());
  ParallelFor(static_cast<int64_t>(recorded.size()), 1, [&](int64_t k) {
    const size_t at = static_cast<size_t>(k);
    recorded[at] = ForceIn(problem, values, misfit, *of_points[at]);
  });
  Eigen::Index count = 0;
  for (const RecordedForce& force : recorded) count += force.columns.cols();
  UnknownForce all{Eigen::MatrixXd(misfit.residual.size(), count), {}};
  Eigen::Index next = 0;
  for (RecordedForce& force : recorded) {
    all.columns.middleCols(next, force.columns.cols()) = force.columns;
    next += force.columns.cols();
    if (!force.untried.empty()) all.untried.push_back(std::move(force.untried));
  }
  return all;
}

}  // namespace lacuna
