#include "diagnosis/unknown_force.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calibration/linear_misfit.h"
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

}  // namespace

Eigen::MatrixXd UnknownForceColumns(const CalibrationProblem& problem,
                                    const Eigen::VectorXd& values, const LinearisedMisfit& misfit) {
  Eigen::MatrixXd all(misfit.residual.size(), 0);
  for (const LinearisedMisfit::Part& part : misfit.parts) {
    if (!part.IsOfPoints()) continue;
    const RecordingModel recording = problem.ModelAt(part.recording, values);
    if (recording.Markers() == nullptr) continue;
    const ReplayedMotion motion = Replay(recording, problem.NuisanceOf(part.recording, values));
    if (!motion.summary.IsUsable()) continue;
    const double start = motion.states.front().time, end = motion.states.back().time;
    const std::vector<double>& times = recording.item().recording.times;
    const auto moving =
        std::count_if(recording.item().frames.begin(), recording.item().frames.end(),
                      [&](int frame) { return times[frame] - motion.delay > start; });
    if (moving < kFewestFrames) continue;
    const SmoothForce field = MakeSmoothForce(recording.model(), start, end,
                                              std::min(kMostKnots, static_cast<int>(moving)));
    const PredictionOptions options = recording.Options(motion.nuisance);
    const ReducedResponse response(recording.model(), motion.states, field.Shapes(),
                                   {.scheme = options.step.scheme, .time_step = options.time_step});
    if (!response.IsUsable()) continue;
    Eigen::MatrixXd own = Eigen::MatrixXd::Zero(misfit.residual.size(), field.amplitudes.size());
    own.middleRows(part.first_row, part.layout.Rows()) =
        ResponseOf(recording, motion, field, response) * PriorRoot(field.KnotCount());
    for (Eigen::Index row = 0; row < part.layout.Rows(); ++row)
      if (part.layout.count[static_cast<size_t>(row)] == 0) own.row(part.first_row + row).setZero();
    const Eigen::MatrixXd visible = VisibleComponents(own, misfit);
    all.conservativeResize(Eigen::NoChange, all.cols() + visible.cols());
    all.rightCols(visible.cols()) = visible;
  }
  return all;
}

}  // namespace lacuna
