#include "calibration/held_out_misfit.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calibration/reaction_errors.h"
#include "core/parallel.h"
#include "prediction/recording_nuisances.h"

namespace lacuna {
namespace {

MisfitMeasure Measure(const RecordingMisfit& recording, bool fitted, double noise) {
  MisfitMeasure measure;
  const Misfit& misfit = recording.misfit;
  const Eigen::Index components = misfit.Components();
  const Eigen::VectorXd residual = misfit.ResidualWithout(recording.place_offset);
  double squares = 0, weighted = 0, at_measured_places = 0;
  for (size_t f = 0; f < recording.fitted.size(); ++f) {
    if (static_cast<bool>(recording.fitted[f]) != fitted) continue;
    ++measure.frames;
    for (int point = 0; point < misfit.points; ++point) {
      const Eigen::Index at = static_cast<Eigen::Index>(f) * misfit.points + point;
      if (misfit.count[at] == 0) continue;
      const double distance = residual.segment(components * at, components).norm();
      squares += distance * distance;
      at_measured_places += misfit.residual.segment(components * at, components).squaredNorm();
      weighted += misfit.count[at] * distance * distance;
      measure.largest = std::max(measure.largest, distance);
      ++measure.points;
    }
  }
  if (measure.points == 0) return measure;
  measure.rms = std::sqrt(squares / measure.points);
  measure.rms_at_measured_places = std::sqrt(at_measured_places / measure.points);
  measure.rms_over_sigma =
      std::sqrt(weighted / measure.points) / (std::sqrt(static_cast<double>(components)) * noise);
  return measure;
}

// The misfit of a recording with markers as `known` has it; nothing if it is not there.
std::optional<Misfit> KnownMisfit(const RecordingModel& model, size_t recording,
                                  const LinearisedMisfit* known) {
  if (known == nullptr || model.recording().ShowsScans()) return std::nullopt;
  std::optional<Misfit> found;
  for (const LinearisedMisfit::Part& part : known->parts) {
    if (part.recording != recording) continue;
    if (part.reaction) {
      found->reactions.push_back({part.layout.series,
                                  known->residual.segment(part.first_row, part.layout.Rows()),
                                  {},
                                  part.layout.count,
                                  part.sign});
      continue;
    }
    const Eigen::Index components = model.observer().Components();
    Misfit misfit;
    misfit.frames = model.recording().frames;
    misfit.points = model.PointCount();
    misfit.residual = known->residual.segment(part.first_row, part.layout.Rows());
    for (size_t k = 0; k < part.layout.count.size(); k += static_cast<size_t>(components))
      misfit.count.push_back(part.layout.count[k]);
    misfit.deformation = part.layout.deformation;
    misfit.observed = part.observed;
    misfit.summary.status = PredictionSummary::Status::kReached;
    found = std::move(misfit);
  }
  return found;
}

// The nuisances and the misfit of a recording. `places`: the errors of its markers' places, where
// other recordings have told them.
RecordingMisfit PredictMisfit(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                              size_t r, const std::optional<Eigen::MatrixXd>& places,
                              const LinearisedMisfit* known,
                              const std::function<void()>& on_frame) {
  const RecordingModel model = problem.ModelAt(r, values);
  const PredictedRecording& item = model.recording();
  RecordingMisfit recording;
  recording.name = item.name;
  recording.nuisance = item.fitted ? problem.NuisanceOf(r, values)
                                   : FitRecordingNuisances(model, problem.ErrorsOf(model), places);
  std::optional<Misfit> predicted = KnownMisfit(model, r, known);
  recording.misfit = predicted ? *std::move(predicted)
                               : model.Predict(item.frames, recording.nuisance, {}, {}, on_frame);
  for (const int frame : recording.misfit.frames) recording.fitted.push_back(item.IsFitted(frame));
  return recording;
}

// Measures the errors of a recording, without those of the places of its points. `places`: as
// above; none where the recording tells them itself.
void MeasureErrors(const CalibrationProblem& problem, size_t r,
                   const std::optional<Eigen::MatrixXd>& places, RecordingMisfit* recording) {
  const RecordingModel& model = problem.models()[r];
  const PredictedRecording& item = model.recording();
  const Misfit& misfit = recording->misfit;
  const MeasurementErrors errors = problem.ErrorsOf(model);
  const std::vector<char> tells_places = TellsPlaces(item, misfit.frames);
  recording->place_offset = places ? *places
                                   : CommonError(misfit.residual, misfit.count, misfit.points,
                                                 errors, tells_places, misfit.deformation);
  std::vector<double> times;
  for (const int frame : misfit.frames) times.push_back(item.recording.times[frame]);
  for (size_t k = 0; k < misfit.reactions.size(); ++k)
    recording->reactions.push_back(MeasureReaction(model.Reactions()[k], misfit.reactions[k], times,
                                                   recording->fitted, tells_places,
                                                   !item.recording.object.forces.empty()));
  recording->in_fit = Measure(*recording, true, errors.noise);
  recording->held_out = Measure(*recording, false, errors.noise);
}

}  // namespace

std::vector<char> TellsPlaces(const PredictedRecording& item, const std::vector<int>& frames) {
  std::vector<char> tells;
  for (const int frame : frames)
    tells.push_back(item.fitted ? item.IsFitted(frame)
                                : item.recording.times[frame] <= item.StartTime());
  return tells;
}

std::vector<RecordingMisfit> MisfitsOf(const CalibrationProblem& problem,
                                       const Eigen::VectorXd& values, const LinearisedMisfit* known,
                                       const std::function<void()>& on_frame) {
  const size_t count = problem.models().size();
  std::vector<RecordingMisfit> all(count);
  std::vector<size_t> fitted, others;
  for (size_t r = 0; r < count; ++r)
    (problem.models()[r].recording().fitted ? fitted : others).push_back(r);
  const auto for_each = [](const std::vector<size_t>& some,
                           const std::function<void(size_t)>& what) {
    ParallelFor(static_cast<int64_t>(some.size()), 1,
                [&](int64_t k) { what(some[static_cast<size_t>(k)]); });
  };
  for_each(fitted, [&](size_t r) {
    all[r] = PredictMisfit(problem, values, r, std::nullopt, known, on_frame);
  });
  // Fitted recordings tell together where the markers are.
  PlaceErrors told = problem.NoPlaceErrors();
  std::vector<char> is_told(count);
  for (const size_t r : fitted) {
    if (problem.PlaceIds(r).empty() || !all[r].misfit.summary.IsUsable()) continue;
    all[r].has_own_places = !problem.AreTold(told, r);
    problem.AddTo(&told, r, all[r].misfit);
    is_told[r] = 1;
  }
  for (const size_t r : others) is_told[r] = problem.AreTold(told, r);
  const Eigen::MatrixXd of_places = told.errors.Mean();
  const auto places = [&](size_t r) -> std::optional<Eigen::MatrixXd> {
    if (!is_told[r]) return std::nullopt;
    return of_places(Eigen::all, problem.PlaceIds(r));
  };
  for_each(others, [&](size_t r) {
    all[r] = PredictMisfit(problem, values, r, places(r), known, on_frame);
    all[r].has_own_places = !is_told[r];
  });
  for (size_t r = 0; r < count; ++r) MeasureErrors(problem, r, places(r), &all[r]);
  return all;
}

}  // namespace lacuna
