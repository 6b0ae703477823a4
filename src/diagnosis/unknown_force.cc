#include "diagnosis/unknown_force.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calibration/linear_misfit.h"
#include "core/parallel.h"
#include "prediction/replayed_motion.h"
#include "prediction/smooth_force.h"

namespace lacuna {
namespace {

constexpr int kShapes = SmoothForce::kShapes;
// The force may change within two frames, but in no more steps than this. More: faster changes in
// long recordings, and a larger eigenvalue problem.
constexpr int kMostKnots = 40;
constexpr int kFewestFrames = 6;    // of the motion
constexpr double kPersistence = 2;  // τ, in knots
// Components of the response that are kept for each recording; those that follow change the
// measurements by less than this share of the noise at the largest prior width, 10 m/s².
constexpr Eigen::Index kMostComponents = 40;
constexpr double kLargestWidth = 10, kLeastVisible = 0.1;

// L with L Lᵀ = exp(−|i − j| / kPersistence) between knots, for each of the six shapes.
Eigen::MatrixXd PriorRoot(int knots) {
  Eigen::MatrixXd correlation(knots, knots);
  for (int i = 0; i < knots; ++i)
    for (int j = 0; j < knots; ++j) correlation(i, j) = std::exp(-std::abs(i - j) / kPersistence);
  const Eigen::MatrixXd in_time = correlation.llt().matrixL();
  Eigen::MatrixXd root = Eigen::MatrixXd::Zero(kShapes * knots, kShapes * knots);
  for (int i = 0; i < knots; ++i)
    for (int j = 0; j <= i; ++j)
      for (int k = 0; k < kShapes; ++k) root(kShapes * i + k, kShapes * j + k) = in_time(i, j);
  return root;
}

// Changes of the predicted markers of all frames per unit of each knot's amplitudes, m.
Eigen::MatrixXd ResponseOf(const RecordingModel& recording, const ReplayedMotion& motion,
                           const SmoothForce& field, const ReducedResponse& response) {
  const Eigen::Index markers = recording.PointCount();
  const std::vector<int>& frames = recording.item().frames;
  const auto histories = [&](double time) {
    Eigen::MatrixXd amplitude = Eigen::MatrixXd::Zero(kShapes, field.amplitudes.size());
    const SmoothForce::KnotWeight at = field.At(time);
    for (int j = 0; j < kShapes; ++j) {
      amplitude(j, kShapes * at.knot + j) = 1 - at.next;
      amplitude(j, kShapes * (at.knot + 1) + j) = at.next;
    }
    return amplitude;
  };
  std::vector<double> times;
  for (const int frame : frames)
    times.push_back(recording.item().recording.times[frame] - motion.delay);
  const Eigen::MatrixXd at_markers = recording.Markers()->rows() * response.basis();
  Eigen::MatrixXd columns(3 * markers * static_cast<Eigen::Index>(frames.size()),
                          field.amplitudes.size());
  response.Respond(histories(field.start), histories, times,
                   [&](int index, const Eigen::MatrixXd& position, const Eigen::MatrixXd&) {
                     const Eigen::MatrixXd moved = at_markers * position;
                     for (Eigen::Index m = 0; m < markers; ++m)
                       columns.middleRows<3>(3 * (markers * index + m)) =
                           motion.registration.linear() * moved.middleRows<3>(3 * m);
                   });
  return columns;
}

// Of the columns of one recording in all rows of the misfit, those combinations that could be seen.
Eigen::MatrixXd VisibleComponents(const Eigen::MatrixXd& columns, const LinearisedMisfit& misfit) {
  const Eigen::MatrixXd white = WhitenedRows(columns, misfit, 0, false);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      Eigen::MatrixXd(white.transpose() * white));
  const double least = std::pow(kLeastVisible / kLargestWidth, 2);
  const Eigen::Index visible =
      std::min<Eigen::Index>(kMostComponents, (eigen.eigenvalues().array() > least).count());
  return columns * eigen.eigenvectors().rightCols(visible);
}

// Those of one recording, whose points are `part`, in all rows of the misfit; none where it shows
// no such force.
Eigen::MatrixXd ColumnsOf(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                          const LinearisedMisfit& misfit, const LinearisedMisfit::Part& part) {
  const Eigen::MatrixXd none(misfit.residual.size(), 0);
  const RecordingModel recording = problem.ModelAt(part.recording, values);
  if (recording.Markers() == nullptr) return none;
  const ReplayedMotion motion = Replay(recording, problem.NuisanceOf(part.recording, values));
  if (!motion.summary.IsUsable()) return none;
  const double start = motion.states.front().time, end = motion.states.back().time;
  const std::vector<double>& times = recording.item().recording.times;
  const auto moving = std::count_if(recording.item().frames.begin(), recording.item().frames.end(),
                                    [&](int frame) { return times[frame] - motion.delay > start; });
  if (moving < kFewestFrames) return none;
  const SmoothForce field = MakeSmoothForce(recording.model(), start, end,
                                            std::min(kMostKnots, static_cast<int>(moving)));
  const PredictionOptions options = recording.Options(motion.nuisance);
  const ReducedResponse response(recording.model(), motion.states, field.Shapes(),
                                 {.scheme = options.step.scheme, .time_step = options.time_step});
  if (!response.IsUsable()) return none;
  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(misfit.residual.size(), field.amplitudes.size());
  own.middleRows(part.first_row, part.layout.Rows()) =
      ResponseOf(recording, motion, field, response) * PriorRoot(field.KnotCount());
  for (Eigen::Index row = 0; row < part.layout.Rows(); ++row)
    if (part.layout.count[static_cast<size_t>(row)] == 0) own.row(part.first_row + row).setZero();
  return VisibleComponents(own, misfit);
}

}  // namespace

Eigen::MatrixXd UnknownForceColumns(const CalibrationProblem& problem,
                                    const Eigen::VectorXd& values, const LinearisedMisfit& misfit) {
  // Without the parts of load cells: a loop over a single recording leaves the other threads to
  // the factorisations inside it.
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
