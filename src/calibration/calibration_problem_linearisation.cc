// The misfit of a calibration problem over all frames, and its derivatives.
#include <glog/logging.h>

#include <algorithm>
#include <iterator>

#include "calibration/calibration_problem.h"
#include "core/interrupt.h"
#include "core/parallel.h"

namespace lacuna {

const LinearisedMisfit::Part& LinearisedMisfit::PointsOf(size_t recording) const {
  const auto found = std::find_if(parts.begin(), parts.end(), [&](const Part& part) {
    return part.recording == recording && part.IsOfPoints();
  });
  CHECK(found != parts.end());
  return *found;
}

CalibrationProblem::LinearisedRecording CalibrationProblem::LineariseRecording(
    size_t recording, const Eigen::VectorXd& values, const LineariseOptions& options,
    const PredictionHints& hints) const {
  const RecordingModel model = ModelAt(recording, values);
  const PredictedRecording& item = model.recording();
  // The clock comes last: the derivative by its delay is minus the speed.
  std::vector<MisfitDirection> wanted;
  if (options.with_jacobian) wanted = DirectionsFor(model, options.directions);
  wanted.push_back({MisfitDirection::Kind::kClock});
  Misfit misfit =
      model.Predict(item.frames, NuisanceOf(recording, values), wanted, hints, options.on_frame);
  LinearisedRecording linearised;
  if (!misfit.summary.IsUsable()) {
    linearised.message = item.name + ": " + misfit.summary.message;
    return linearised;
  }
  const auto columns = [&](const Eigen::MatrixXd& by) {
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
  part.observed = std::move(misfit.observed);
  part.held = std::move(misfit.summary.held);
  part.speed = -misfit.jacobian.rightCols<1>();
  if (options.with_jacobian) linearised.jacobian = columns(misfit.jacobian);
  linearised.residual = std::move(misfit.residual);
  for (size_t k = 0; k < misfit.reactions.size(); ++k) {
    const ReactionMisfit& reaction = misfit.reactions[k];
    LinearisedMisfit::Part& of_force = linearised.parts.emplace_back();
    of_force.recording = recording;
    of_force.reaction = k;
    of_force.first_row = linearised.residual.size();
    of_force.errors = ReadingErrors(model.Reactions()[k]);
    of_force.layout = {reaction.components, part.layout.times, reaction.count, {}};
    of_force.fitted = part.fitted;
    of_force.speed = -reaction.jacobian.rightCols<1>();
    of_force.sign = reaction.sign;
    linearised.residual.conservativeResize(of_force.first_row + reaction.residual.size());
    linearised.residual.tail(reaction.residual.size()) = reaction.residual;
    if (!options.with_jacobian) continue;
    linearised.jacobian.conservativeResize(linearised.residual.size(), Eigen::NoChange);
    linearised.jacobian.bottomRows(reaction.residual.size()) = columns(reaction.jacobian);
  }
  linearised.parts.insert(linearised.parts.begin(), std::move(part));
  return linearised;
}

int64_t CalibrationProblem::LinearisedFrames() const {
  int64_t frames = 0;
  for (const size_t recording : FittedRecordings())
    frames += static_cast<int64_t>(models_[recording].recording().frames.size());
  return frames;
}

LinearisedMisfit CalibrationProblem::Linearise(const Eigen::VectorXd& values,
                                               const LineariseOptions& options) const {
  ThrowIfInterrupted();
  const std::vector<size_t> fitted = FittedRecordings();
  std::vector<LinearisedRecording> recordings(fitted.size());
  ParallelFor(static_cast<int64_t>(fitted.size()), 1, [&](int64_t at) {
    const size_t k = static_cast<size_t>(at);
    PredictionHints hints;
    if (options.correspondences != nullptr)
      hints.observed = &options.correspondences->PointsOf(fitted[k]).observed;
    if (options.near != nullptr && options.near->usable)
      hints.near_equilibrium = &options.near->PointsOf(fitted[k]).held;
    recordings[k] = LineariseRecording(fitted[k], values, options, hints);
  });
  LinearisedMisfit all;
  Eigen::Index rows = 0;
  for (LinearisedRecording& recording : recordings) {
    all.message = recording.message;
    if (!all.message.empty()) return all;
    for (LinearisedMisfit::Part& part : recording.parts) part.first_row += rows;
    rows += recording.residual.size();
  }
  all.residual.resize(rows);
  if (options.with_jacobian)
    all.jacobian.resize(rows,
                        static_cast<Eigen::Index>(parameters_.size() + options.directions.size()));
  for (LinearisedRecording& recording : recordings) {
    const Eigen::Index first = recording.parts.front().first_row;
    const Eigen::Index count = recording.residual.size();
    all.residual.segment(first, count) = recording.residual;
    if (options.with_jacobian) all.jacobian.middleRows(first, count) = recording.jacobian;
    std::move(recording.parts.begin(), recording.parts.end(), std::back_inserter(all.parts));
  }
  all.usable = true;
  return all;
}

}  // namespace lacuna
