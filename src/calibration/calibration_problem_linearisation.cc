// The misfit of a calibration problem over all frames, and its derivatives.
#include <fmt/format.h>

#include <iterator>

#include "calibration/calibration_problem.h"
#include "core/interrupt.h"
#include "core/parallel.h"

namespace lacuna {
namespace {

// A frame is lost where the share of its points with a correspondence is less than this fraction of
// the share in the best frame.
constexpr double kFewestMatched = 0.5;

// The reason why the correspondences of a scan cannot be used; empty where they can.
std::string Mismatch(const RecordingModel& model, const Misfit& misfit) {
  const size_t lost = model.LostFrames(misfit, kFewestMatched).size();
  if (2 * lost <= misfit.frames.size()) {
    if (!model.recording().ShowsScans() || misfit.observed.empty()) return "";
    const Observed& first = misfit.observed.front();
    if (model.Shows(first)) return "";
    return fmt::format(
        "frame {} shows {} of {} patches of the predicted surface: the length unit of its points, "
        "their transform or their normals are wrong, or it shows too little of the object",
        misfit.frames.front(), (first.count.array() > 0).count(), misfit.points);
  }
  return fmt::format(
      "in {} of {} frames most scanned points are farther than scan.reach from the predicted "
      "surface: start nearer to the solution, increase scan.reach, or crop the scans to the object",
      lost, misfit.frames.size());
}

}  // namespace

CalibrationProblem::PredictedRows CalibrationProblem::RowsOf(
    const FrameRequest& request, const Eigen::VectorXd& values,
    const LineariseOptions& options) const {
  const size_t recording = request.recording;
  const RecordingModel model = ModelAt(recording, values);
  const PredictedRecording& item = model.recording();
  // The clock comes last: the derivative by its delay is minus the speed.
  std::vector<MisfitDirection> wanted;
  if (options.with_jacobian) wanted = DirectionsFor(model, options.directions);
  wanted.push_back({MisfitDirection::Kind::kClock});
  Misfit misfit = model.Predict(request.frames, NuisanceOf(recording, values), wanted,
                                request.hints, options.on_frame);
  PredictedRows rows;
  if (!misfit.summary.IsUsable())
    rows.message = misfit.summary.message;
  else if (request.needs_matches)
    rows.message = Mismatch(model, misfit);
  if (!rows.message.empty()) {
    rows.message = item.name + ": " + rows.message;
    return rows;
  }
  const auto columns = [&](const Eigen::MatrixXd& by) -> Eigen::MatrixXd {
    if (!options.with_jacobian) return Eigen::MatrixXd(by.rows(), 0);
    return ColumnsOf(recording, by.leftCols(by.cols() - 1),
                     static_cast<Eigen::Index>(options.directions.size()));
  };
  LinearisedMisfit::Part part;
  part.recording = recording;
  part.errors = ErrorsOf(model);
  const Eigen::Index components = model.observer().Components();
  part.layout.series = static_cast<int>(components) * model.PointCount();
  for (const int frame : misfit.frames) {
    part.layout.times.push_back(item.recording.times[frame]);
    part.fitted.push_back(item.IsFitted(frame));
  }
  for (const double count : misfit.count)
    part.layout.count.insert(part.layout.count.end(), static_cast<size_t>(components), count);
  part.layout.deformation = std::move(misfit.deformation);
  part.layout.offset_ids = place_ids_[recording];
  part.observed = std::move(misfit.observed);
  part.held = std::move(misfit.summary.held);
  part.speed = -misfit.jacobian.rightCols<1>();
  rows.jacobian = columns(misfit.jacobian);
  rows.residual = std::move(misfit.residual);
  for (size_t k = 0; k < misfit.reactions.size(); ++k) {
    const ReactionMisfit& reaction = misfit.reactions[k];
    LinearisedMisfit::Part& of_force = rows.parts.emplace_back();
    of_force.recording = recording;
    of_force.reaction = k;
    of_force.first_row = rows.residual.size();
    of_force.errors = ReadingErrors(model.Reactions()[k]);
    of_force.layout = {reaction.components, part.layout.times, reaction.count, {}};
    of_force.fitted = part.fitted;
    of_force.speed = -reaction.jacobian.rightCols<1>();
    of_force.sign = reaction.sign;
    rows.residual.conservativeResize(of_force.first_row + reaction.residual.size());
    rows.residual.tail(reaction.residual.size()) = reaction.residual;
    rows.jacobian.conservativeResize(rows.residual.size(), Eigen::NoChange);
    rows.jacobian.bottomRows(reaction.residual.size()) = columns(reaction.jacobian);
  }
  rows.parts.insert(rows.parts.begin(), std::move(part));
  return rows;
}

int64_t CalibrationProblem::LinearisedFrames() const {
  int64_t frames = 0;
  for (const size_t recording : FittedRecordings())
    frames += static_cast<int64_t>(models_[recording].recording().frames.size());
  return frames;
}

LinearisedMisfit CalibrationProblem::Joined(std::vector<PredictedRows> recordings) {
  LinearisedMisfit all;
  Eigen::Index rows = 0;
  for (PredictedRows& recording : recordings) {
    all.message = recording.message;
    if (!all.message.empty()) return all;
    for (LinearisedMisfit::Part& part : recording.parts) part.first_row += rows;
    rows += recording.residual.size();
  }
  all.residual.resize(rows);
  if (!recordings.empty()) all.jacobian.resize(rows, recordings.front().jacobian.cols());
  for (PredictedRows& recording : recordings) {
    const Eigen::Index first = recording.parts.front().first_row;
    const Eigen::Index count = recording.residual.size();
    all.residual.segment(first, count) = recording.residual;
    all.jacobian.middleRows(first, count) = recording.jacobian;
    std::move(recording.parts.begin(), recording.parts.end(), std::back_inserter(all.parts));
  }
  all.usable = true;
  return all;
}

LinearisedMisfit CalibrationProblem::Linearise(const Eigen::VectorXd& values,
                                               const LineariseOptions& options) const {
  ThrowIfInterrupted();
  const std::vector<size_t> fitted = FittedRecordings();
  std::vector<PredictedRows> recordings(fitted.size());
  ParallelFor(static_cast<int64_t>(fitted.size()), 1, [&](int64_t at) {
    const size_t k = static_cast<size_t>(at);
    FrameRequest all{fitted[k], models_[fitted[k]].recording().frames};
    if (options.correspondences != nullptr)
      all.hints.observed = &options.correspondences->PointsOf(fitted[k]).observed;
    if (options.near != nullptr && options.near->usable)
      all.hints.near_equilibrium = &options.near->PointsOf(fitted[k]).held;
    recordings[k] = RowsOf(all, values, options);
  });
  return Joined(std::move(recordings));
}

}  // namespace lacuna
