#include "exchange/described_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "calibration/calibration_run.h"
#include "core/error.h"
#include "core/suggestion.h"
#include "record/library_versions.h"

namespace lacuna {
namespace {

size_t FindRecording(const FittedRun& fitted, const std::string& name) {
  if (name.empty()) return 0;
  std::vector<std::string> names;
  for (const PredictedRecording& item : fitted.study.recordings) names.push_back(item.name);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw InputError(fmt::format("the run has no recording \"{}\"{}; its recordings: {}", name,
                                 Suggestion(name, names), fmt::join(names, ", ")));
  return static_cast<size_t>(found - names.begin());
}

NamedNodes Select(const Region& region, const std::string& name, const TetMesh& mesh) {
  return {name, SelectNodes(region, mesh)};
}

PortableNames NamesOf(const PredictedRecording& item, const TetMesh& mesh) {
  const RecordedObject& object = item.recording.object;
  PortableNames names{HeldParts(object), {}};
  for (const MeasuredForce& force : object.forces) {
    names.loads.push_back(force.name);
    names.regions.push_back(Select(*force.region, force.name, mesh));
  }
  if (item.hold) names.regions.push_back(Select(item.hold->region, "hold", mesh));
  return names;
}

std::vector<PortableParameter> ParametersOf(const CalibrationRecord& record) {
  std::vector<PortableParameter> parameters;
  for (const FittedParameter& parameter : record.parameters)
    parameters.push_back({parameter.name,
                          parameter.unit,
                          {parameter.estimate.value},
                          true,
                          parameter.estimate.low,
                          parameter.estimate.high,
                          parameter.at_limit});
  for (const HeldParameter& parameter : record.held)
    parameters.push_back({parameter.name, parameter.unit, parameter.values});
  return parameters;
}

}  // namespace

std::vector<double> FramesUntil(double until, const std::vector<double>& times, double delay,
                                double start) {
  std::vector<double> frames;
  for (const double time : times) {
    const double frame = time - delay;
    if (time <= until) {
      frames.push_back(frame);
    } else if (frame > start && (frames.empty() || frames.back() <= start)) {
      throw InputError(fmt::format(
          "--until {} leaves nothing of the motion, whose first frame is at {} s", until, time));
    }
  }
  return frames;
}

DescribedRun DescribeRun(const std::filesystem::path& run, const DescribedRunOptions& options) {
  const FittedRun fitted = OpenRun(run);
  const size_t index = FindRecording(fitted, options.recording);
  const PredictedRecording& item = fitted.study.recordings[index];
  const CalibrationProblem problem(fitted.study, fitted.mesh);
  const RecordingModel model = problem.ModelAt(index, fitted.values);
  const Eigen::VectorXd nuisance = problem.NuisanceOf(index, fitted.values);
  std::vector<double> times;
  for (const int frame : item.frames)
    times.push_back(item.recording.times[static_cast<size_t>(frame)]);
  DescribedRun described{{}, model.PlacedModel(nuisance), model.Options(nuisance)};
  const std::vector<double> frames =
      FramesUntil(options.until, times, model.Delay(nuisance), described.prediction.start_time);
  described.model = DescribeModel(described.source, fitted.mesh, described.prediction, frames,
                                  NamesOf(item, fitted.mesh));
  described.model.run = fitted.study.name;
  described.model.experiment = fitted.study.file.filename().string();
  described.model.recording = item.name;
  described.model.program_version = ProgramVersion();
  described.model.parameters = ParametersOf(fitted.record);
  return described;
}

Eigen::MatrixXd PredictPositions(const DescribedRun& run) {
  std::vector<double> times;
  for (const double frame : run.model.frames) times.push_back(run.model.start + frame);
  Eigen::MatrixXd positions(3 * run.source.body->NodeCount(),
                            static_cast<Eigen::Index>(times.size()) + 1);
  const PredictionSummary summary = Predict(
      run.source, run.prediction, times, {},
      [&](int index, const PredictedState& state) { positions.col(index + 1) = state.position; });
  if (!summary.IsUsable())
    throw InputError("the motion could not be predicted: " + summary.message);
  positions.col(0) = summary.held;
  return positions;
}

}  // namespace lacuna
