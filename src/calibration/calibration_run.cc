#include "calibration/calibration_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>

#include "calibration/adaptive_time_step.h"
#include "calibration/data_kinds.h"
#include "calibration/data_shares.h"
#include "calibration/known_errors.h"
#include "calibration/misfit_report.h"
#include "calibration/prior_conflicts.h"
#include "calibration/reaction_report.h"
#include "core/error.h"
#include "experiment/reference_body_stage.h"
#include "prediction/predicted_body.h"
#include "prediction/prediction_study_reader.h"
#include "prediction/recording_noise.h"
#include "record/csv_table.h"
#include "record/input_files.h"
#include "record/run_stage.h"

namespace lacuna {
namespace {

// Incremented whenever a change of the code changes the result of the stage, or its files.
constexpr int kCalibrationVersion = 37;

// What the model has besides the fitted parameters. A vector none of whose components is fitted is
// one entry.
std::vector<HeldParameter> HeldIn(const PredictionStudy& study) {
  std::vector<HeldParameter> held;
  if (study.density_deviation == 0) held.push_back({"density", "kg/m^3", {study.density}});
  std::vector<ModelParameter> others = ModelParameters(study.effects, ScaleOf(study));
  std::erase_if(others, [&](const ModelParameter& parameter) {
    return std::any_of(study.fitted.begin(), study.fitted.end(), [&](const ModelParameter& fitted) {
      return fitted.places.front() == parameter.places.front();
    });
  });
  for (size_t k = 0; k < others.size(); ++k) {
    const std::string& name = others[k].prior.name;
    HeldParameter& entry =
        held.emplace_back(HeldParameter{name, others[k].unit, {others[k].prior.start}});
    if (!name.ends_with("_x") || k + 2 >= others.size()) continue;
    const std::string stem = name.substr(0, name.size() - 2);
    if (others[k + 1].prior.name != stem + "_y" || others[k + 2].prior.name != stem + "_z")
      continue;
    entry.name = stem;
    for (int component = 1; component < 3; ++component)
      entry.values.push_back(others[++k].prior.start);
  }
  return held;
}

// Says for which recordings the simulation stops before the last frame, so that their errors cover
// only a part of the frames.
std::vector<std::string> NotesOnStops(const CalibrationProblem& problem,
                                      const std::vector<RecordingMisfit>& misfits) {
  std::vector<std::string> notes;
  for (size_t r = 0; r < misfits.size(); ++r) {
    const Misfit& misfit = misfits[r].misfit;
    if (misfit.summary.IsUsable()) continue;
    const PredictedRecording& item = problem.models()[r].recording();
    notes.push_back(fmt::format(
        "{}: the simulation stops before the last frame, so that all errors are those of {} of its "
        "{} frames{}: {}",
        misfits[r].name, misfit.frames.size(), item.frames.size(),
        misfit.frames.empty()
            ? ""
            : fmt::format(", up to {:.4g} s", item.recording.times[misfit.frames.back()]),
        misfit.summary.message));
  }
  return notes;
}

struct CalibrationStage {
  CalibrationRecord record;
  CsvTable misfit, reactions, torques;
  std::optional<OtherMesh> other_mesh;  // with which the error of the mesh was estimated
};

// The outcome of the fit itself.
CalibrationRecord DescribeFit(const AdaptedFit& fit, const PredictionStudy& study,
                              const CalibrationProblem& problem) {
  const Calibration& calibration = fit.calibration;
  CalibrationRecord record;
  // A relative path, so that the runs can be moved together with the experiments.
  record.experiment =
      std::filesystem::absolute(study.file)
          .lexically_normal()
          .lexically_proximate(std::filesystem::absolute(study.output).lexically_normal());
  // Parameters that were not quite reached are worth a comparison and a diagnosis: a fit that takes
  // too many predictions or iterations usually lacks physics.
  record.usable = calibration.usable || calibration.is_out_of_budget;
  record.message = calibration.message;
  if (!fit.note.empty()) record.notes.push_back(fit.note);
  record.noise = problem.noise();
  record.scan_noise = problem.scan_noise();
  record.time_step = study.time_step;
  record.step_error = fit.step_error;
  record.start_rms = calibration.start_rms;
  record.rms = calibration.rms;
  record.predictions = calibration.predictions;
  for (size_t k = 0; k < calibration.estimates.size(); ++k) {
    const CalibratedParameter& prior = problem.parameters()[k];
    record.parameters.push_back(
        {prior.name, problem.UnitOf(k), prior.log_scale, calibration.estimates[k], std::nullopt});
  }
  record.held = HeldIn(study);
  return record;
}

// Says that an estimate of the noise contains motion, where the model errs by much less. Empty
// where it does not.
std::string NoteOnNoise(const CalibrationProblem& problem,
                        const std::vector<RecordingMisfit>& misfits) {
  constexpr double kFarLess = 0.5;                   // of σ: noise alone leaves about 1
  if (problem.LeastNoiseVariance() == 1) return "";  // it is not estimated
  double largest = 0;
  for (const RecordingMisfit& misfit : misfits)
    largest = std::max({largest, misfit.in_fit.rms_over_sigma, misfit.held_out.rms_over_sigma});
  if (largest >= kFarLess) return "";
  return fmt::format(
      "the noise, σ = {:.3g} mm per coordinate, was estimated from frames that do not show the "
      "object at rest, and is too large: the model errs by no more than {:.2g} σ. Give `noise`; "
      "until then, all errors in σ, intervals and verdicts are too favourable to the model",
      1e3 * problem.noise(), largest);
}

FittedRecording DescribeRecording(const RecordingModel& model, const RecordingMisfit& misfit,
                                  double scan_noise) {
  const PredictedRecording& item = model.recording();
  FittedRecording recording{
      misfit.name,   item.fitted,     EstimateRecordingNoise(item, item.frames),
      misfit.in_fit, misfit.held_out, std::nullopt};
  recording.reactions = misfit.reactions;
  const auto& own = model.nuisances();
  for (size_t k = 0; k < own.size() && !item.fitted; ++k)
    recording.own.push_back(
        {own[k].prior.name, own[k].unit, misfit.nuisance[static_cast<Eigen::Index>(k)]});
  if (item.ShowsScans())
    recording.scan = DescribeScan(misfit, model.observer().Places(), scan_noise);
  else
    recording.marker_names = item.recording.markers.names;
  return recording;
}

// Shifts and widens the intervals of the parameters by the errors of the model that the fit does
// not estimate.
void CountKnownErrors(const CalibrationProblem& problem, const KnownErrors& errors,
                      CalibrationRecord* record) {
  for (size_t k = 0; k < record->parameters.size(); ++k) {
    const Eigen::Index at = static_cast<Eigen::Index>(k);
    FittedParameter& parameter = record->parameters[k];
    if (errors.at_mesh_limit.size() > 0) parameter.with_finest_mesh = errors.at_mesh_limit[at];
    parameter.at_limit = errors.at_limit[at];
    WidenIntervalByModelErrors(problem.parameters()[k], *parameter.at_limit, errors.deviation[at],
                               &parameter.estimate);
  }
  record->notes.insert(record->notes.end(), errors.notes.begin(), errors.notes.end());
}

// The number of frames that are predicted to describe a fit: those of all recordings once, and
// those of the fitted ones once more where they have several kinds of data (SharesOfData).
int64_t FramesToDescribe(const CalibrationProblem& problem) {
  int64_t frames = HasSeveralKinds(problem) ? problem.LinearisedFrames() : 0;
  for (const RecordingModel& model : problem.models())
    frames += static_cast<int64_t>(model.recording().frames.size());
  return frames;
}

CalibrationStage FitAndDescribe(PredictionStudy study, const ReferenceBody& reference,
                                Progress* progress, FitStore* kept) {
  const AdaptedFit fit = FitWithAdaptiveTimeStep(reference.mesh, &study, progress, kept);
  const Eigen::VectorXd& values = fit.calibration.parameters;
  const CalibrationProblem problem(study, reference.mesh);
  CalibrationStage stage;
  CalibrationRecord& record = stage.record;
  record = DescribeFit(fit, study, problem);
  if (record.parameters.size() != problem.parameters().size()) return stage;  // no prediction
  progress->Begin("predict", FramesToDescribe(problem));
  const std::function<void()> on_frame = StageCounter(progress);
  const std::vector<RecordingMisfit> misfits =
      MisfitsOf(problem, values, /*known=*/nullptr, on_frame);
  for (size_t r = 0; r < misfits.size(); ++r)
    record.recordings.push_back(
        DescribeRecording(problem.models()[r], misfits[r], problem.scan_noise()));
  record.prior_conflicts = FindPriorConflicts(problem, values, misfits);
  const std::vector<std::string> stops = NotesOnStops(problem, misfits);
  record.notes.insert(record.notes.end(), stops.begin(), stops.end());
  if (std::string note = NoteOnNoise(problem, misfits); !note.empty())
    record.notes.push_back(std::move(note));
  stage.misfit = MisfitTable(problem, misfits);
  stage.reactions = ReactionTable(problem, misfits, /*torques=*/false);
  stage.torques = ReactionTable(problem, misfits, /*torques=*/true);
  const std::vector<std::optional<DataShares>> shares = SharesOfData(problem, values, on_frame);
  for (size_t k = 0; k < shares.size(); ++k) record.parameters[k].shares = shares[k];
  progress->End();
  if (record.rms <= kFarFromTruth) {
    progress->Begin("errors of the model", 0);
    const KnownErrors errors = FindKnownErrors(problem, values, progress);
    CountKnownErrors(problem, errors, &record);
    stage.other_mesh = errors.other_mesh;
    progress->End();
  }
  for (size_t k = 0; k < record.parameters.size(); ++k) {
    const CalibratedParameter& prior = problem.parameters()[k];
    FittedParameter& parameter = record.parameters[k];
    parameter.near_bound =
        FindNearBound(parameter.estimate, parameter.log_scale, prior.min, prior.max);
  }
  return stage;
}

InputFiles InputsOf(const PredictionStudy& study) {
  InputFiles inputs;
  for (const PredictedRecording& item : study.recordings)
    for (const FileState& file : item.recording.files)
      inputs.Add(item.name + "/" + InputName(file.file, item.recording.file.parent_path()), file);
  return inputs;
}

}  // namespace

CalibrationRecord RunCalibration(const PredictionStudy& study, Progress* progress) {
  RunDirectory run(study.output);
  const InputFiles files = InputsOf(study);
  const std::map<std::string, std::string>& inputs = files.hashes();
  run.Begin(study.configuration, inputs, 0);
  run.Watch(files);

  nlohmann::json behind_mesh = study.configuration.at("mesh");
  if (study.recordings.front().recording.reference.source == ReferenceSource::kFirstFrame) {
    behind_mesh["scan"] = study.configuration.value("scan", nlohmann::json::object());
    behind_mesh["first_frame"] = study.recordings.front().frames.front();
  }
  const ReferenceBody reference = RunReferenceBodyStage(&run, behind_mesh, inputs, progress,
                                                        [&] { return MakeReferenceBody(study); });

  std::map<std::string, std::string> behind = inputs;
  behind["mesh"] = run.ResultHash("mesh");
  FitStore kept(study.output / "fits.json", {{"version", kCalibrationVersion},
                                             {"configuration", study.configuration.dump()},
                                             {"behind", behind}});
  CalibrationStage stage = RunStage<CalibrationStage>(
      &run, {"calibration", kCalibrationVersion, study.configuration, behind}, progress,
      [&] { return FitAndDescribe(study, reference, progress, &kept); },
      [](const CalibrationStage& value, const std::filesystem::path& folder) {
        WriteCalibrationFile(value.record, folder / "calibration.json");
        if (!value.misfit.empty()) WriteCsv(value.misfit, folder / "misfit.csv");
        if (!value.reactions.empty()) WriteCsv(value.reactions, folder / "reactions.csv");
        if (!value.torques.empty()) WriteCsv(value.torques, folder / "torques.csv");
        if (value.other_mesh) WriteOtherMesh(*value.other_mesh, folder);
      },
      [](const std::filesystem::path& folder) {
        return CalibrationStage{ReadCalibrationFile(folder / "calibration.json"), {}, {}, {}, {}};
      });
  kept.Drop();
  run.Finish();
  stage.record.mesh = reference.quality;
  stage.record.mesh_notes = reference.notes;
  return stage.record;
}

void RefuseOtherRuns(const std::filesystem::path& run) {
  if (!std::filesystem::exists(run))
    throw InputError({run.string()}, "there is no such file or folder");
  if (!std::filesystem::exists(run / "manifest.json")) {
    throw InputError({run.string()},
                     "is not a run: it holds no manifest.json; lacuna fit EXPERIMENT makes one");
  }
  const Manifest manifest = ReadManifest(run / "manifest.json");
  if (manifest.stages.contains("calibration") || manifest.configuration.contains("recordings"))
    return;  // FinishedStage says what is wrong with it, if anything
  throw InputError({run.string()},
                   manifest.configuration.contains("recording")
                       ? "is a run of `lacuna reconstruct`, which fits forces until the model "
                         "follows the recording; a prediction is needed, a run of `lacuna fit`"
                       : "is not a run of `lacuna fit`");
}

FittedRun OpenRun(const std::filesystem::path& run) {
  RefuseOtherRuns(run);
  FittedRun opened;
  opened.record = ReadCalibration(run);
  if (!opened.record.usable) {
    throw InputError(
        fmt::format("{}: its fit is not usable: {}", run.string(), opened.record.message));
  }
  const std::filesystem::path experiment = (run / opened.record.experiment).lexically_normal();
  opened.study = ReadPredictionStudy(Config::Load(experiment));
  const Manifest manifest = ReadManifest(run / "manifest.json");
  const auto changed = [&](const std::string& what) {
    return InputError(fmt::format("{}: {} has changed since the fit; run `lacuna fit` again",
                                  run.string(), what));
  };
  // Compared as text, because JSON writes an infinite bound as null.
  if (opened.study.configuration.dump() != manifest.configuration.dump())
    throw changed(experiment.string());
  const std::map<std::string, std::string> inputs = InputsOf(opened.study).hashes();
  for (const auto& [file, hash] : inputs) {
    const auto then = manifest.inputs.find(file);
    if (then == manifest.inputs.end() || then->second != hash) throw changed(file);
  }
  if (inputs.size() != manifest.inputs.size()) throw changed("the list of its recordings' files");
  opened.study.time_step = opened.record.time_step;
  opened.mesh = ReadReferenceBody(FinishedStage(run, "mesh")).mesh;
  opened.values.resize(static_cast<Eigen::Index>(opened.record.parameters.size()));
  for (size_t k = 0; k < opened.record.parameters.size(); ++k)
    opened.values[static_cast<Eigen::Index>(k)] = opened.record.parameters[k].estimate.value;
  opened.study.effects = WithValues(opened.study.effects, opened.study.fitted, opened.values);
  return opened;
}

CalibrationRecord ReadCalibration(const std::filesystem::path& run) {
  return ReadCalibrationFile(FinishedStage(run, "calibration") / "calibration.json");
}

}  // namespace lacuna
