#include "diagnosis/unknown_force.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
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

// The columns of one recording, whose points are `part`, in all rows of the misfit; none where the
// recording would not show such a force.
Eigen::MatrixXd ColumnsOf(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                          const LinearisedMisfit& misfit, const LinearisedMisfit::Part& part) {
  const Eigen::MatrixXd none(misfit.residual.size(), 0);
  const RecordingModel recording = problem.ModelAt(part.recording, values);
  const ReplayedMotion motion = Replay(recording, problem.NuisanceOf(part.recording, values));
  if (!motion.summary.IsUsable()) return none;
  const std::optional<SmoothForce> field = SmoothForceDuring(recording, motion, kMostKnots);
  if (!field) return none;
  const PredictionOptions options = recording.Options(motion.nuisance);
  const ReducedResponse response(recording.model(), motion.states, field->Shapes(),
                                 {.scheme = options.step.scheme, .time_step = options.time_step});
  if (!response.IsUsable()) return none;
  const ForceHistories hat_functions = [&](double time) { return field->HatFunctions(time); };
  std::vector<int> frames(part.observed.size());
  std::iota(frames.begin(), frames.end(), 0);
  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(misfit.residual.size(), field->amplitudes.size());
  own.middleRows(part.first_row, part.layout.Rows()) =
      ObservedResponse(recording, motion, response, hat_functions(field->start), hat_functions,
                       frames, part.observed) *
      PersistentPriorRoot(field->KnotCount(), kPersistence);
  return VisibleComponents(own, misfit);
}

}  // namespace

Eigen::MatrixXd UnknownForceColumns(const CalibrationProblem& problem,
                                    const Eigen::VectorXd& values, const LinearisedMisfit& misfit) {
  // One part for each recording; the load cells have parts of their own, without points.
  std::vector<const LinearisedMisfit::Part*> of_points;
  for (const LinearisedMisfit::Part& part : misfit.parts)
    if (part.IsOfPoints()) of_points.push_back(&part);
  std::vector<Eigen::MatrixXd> visible(of_points.size());
  ParallelFor(static_cast<int64_t>(visible.size()), 1, [&](int64_t k) {
    const size_t at = static_cast<size_t>(k);
    visible[at] = ColumnsOf(problem, values, misfit, *of_points[at]);
  });
  Eigen::Index count = 0;
  for (const Eigen::MatrixXd& columns : visible) count += columns.cols();
  Eigen::MatrixXd all(misfit.residual.size(), count);
  Eigen::Index next = 0;
  for (const Eigen::MatrixXd& columns : visible) {
    all.middleCols(next, columns.cols()) = columns;
    next += columns.cols();
  }
  return all;
}

}  // namespace lacuna
