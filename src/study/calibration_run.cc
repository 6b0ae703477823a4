#include "study/calibration_run.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/hash.h"
#include "record/csv_table.h"
#include "study/run_stage.h"

namespace lacuna {
namespace {

using nlohmann::json;
using Verdict = ParameterEstimate::Verdict;

// Raised when the stage's code changes so that its result does.
constexpr int kMeshVersion = 1;
constexpr int kCalibrationVersion = 2;

const std::vector<std::pair<Verdict, std::string>>& VerdictNames() {
  static const std::vector<std::pair<Verdict, std::string>> names{
      {Verdict::kPinnedDown, "pinned down"},
      {Verdict::kDead, "dead"},
      {Verdict::kFlat, "flat"},
      {Verdict::kTradedOff, "traded off"},
      {Verdict::kAtBound, "at its bound"}};
  return names;
}

// JSON has neither infinity nor NaN: null.
json Number(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }
double FromNumber(const json& value, double otherwise) {
  return value.is_null() ? otherwise : value.get<double>();
}

json MeasureToJson(const MisfitMeasure& measure) {
  return {{"frames", measure.frames},
          {"points", measure.points},
          {"rms_m", measure.rms},
          {"largest_m", measure.largest},
          {"in_noise", measure.in_noise}};
}

MisfitMeasure MeasureFromJson(const json& value) {
  return {value.at("frames"), value.at("points"), value.at("rms_m"), value.at("largest_m"),
          value.at("in_noise")};
}

json ToJson(const CalibrationRecord& record) {
  json parameters = json::array();
  for (const FittedParameter& parameter : record.parameters) {
    const ParameterEstimate& estimate = parameter.estimate;
    parameters.push_back({{"name", parameter.name},
                          {"unit", parameter.unit},
                          {"log_scale", parameter.log_scale},
                          {"value", estimate.value},
                          {"low_95", Number(estimate.low)},
                          {"high_95", Number(estimate.high)},
                          {"deviation_from_data", Number(estimate.deviation)},
                          {"deviation", Number(estimate.posterior_deviation)},
                          {"verdict", VerdictName(estimate.verdict)},
                          {"most_correlated_with", estimate.traded_with},
                          {"correlation", estimate.correlation}});
  }
  json recordings = json::array();
  for (const FittedRecording& recording : record.recordings) {
    recordings.push_back({{"name", recording.name},
                          {"fitted", recording.fitted},
                          {"noise_m", recording.noise},
                          {"in_fit", MeasureToJson(recording.in_fit)},
                          {"held_out", MeasureToJson(recording.held_out)}});
  }
  return {{"schema_version", 1},
          {"experiment", record.experiment.generic_string()},
          {"usable", record.usable},
          {"message", record.message},
          {"noise_m", record.noise},
          {"rms_before", Number(record.start_rms)},
          {"rms_after", Number(record.rms)},
          {"predictions", record.predictions},
          {"parameters", parameters},
          {"recordings", recordings},
          {"strains", record.strains}};
}

CalibrationRecord FromJson(const json& value) {
  CalibrationRecord record;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  record.experiment = value.at("experiment").get<std::string>();
  record.usable = value.at("usable");
  record.message = value.at("message");
  record.noise = value.at("noise_m");
  record.start_rms = FromNumber(value.at("rms_before"), kInfinity);
  record.rms = FromNumber(value.at("rms_after"), kInfinity);
  record.predictions = value.at("predictions");
  for (const json& entry : value.at("parameters")) {
    FittedParameter parameter;
    parameter.name = entry.at("name");
    parameter.unit = entry.at("unit");
    parameter.log_scale = entry.at("log_scale");
    ParameterEstimate& estimate = parameter.estimate;
    estimate.value = entry.at("value");
    estimate.low = FromNumber(entry.at("low_95"), -kInfinity);
    estimate.high = FromNumber(entry.at("high_95"), kInfinity);
    estimate.deviation = FromNumber(entry.at("deviation_from_data"), kInfinity);
    estimate.posterior_deviation = FromNumber(entry.at("deviation"), kInfinity);
    for (const auto& [verdict, name] : VerdictNames())
      if (name == entry.at("verdict")) estimate.verdict = verdict;
    estimate.traded_with = entry.at("most_correlated_with");
    estimate.correlation = entry.at("correlation");
    record.parameters.push_back(parameter);
  }
  for (const json& entry : value.at("recordings"))
    record.recordings.push_back({entry.at("name"), entry.at("fitted"), entry.at("noise_m"),
                                 MeasureFromJson(entry.at("in_fit")),
                                 MeasureFromJson(entry.at("held_out"))});
  record.strains = value.at("strains").get<std::vector<std::string>>();
  return record;
}

CalibrationRecord ReadCalibrationFile(const std::filesystem::path& file) {
  std::ifstream stream(file);
  try {
    return FromJson(json::parse(stream));
  } catch (const json::exception& problem) {
    throw InputError(file.string() + ": is no record of a calibration: " + problem.what());
  }
}

// Every marker of every frame; lengths in m.
CsvTable MisfitTable(const CalibrationProblem& problem,
                     const std::vector<RecordingMisfit>& misfits) {
  std::vector<std::vector<double>> columns(11);
  for (size_t r = 0; r < misfits.size(); ++r) {
    const RecordingMisfit& recording = misfits[r];
    const RecordingModel& model = problem.models()[r];
    const int markers = model.MarkerCount();
    for (size_t f = 0; f < recording.misfit.frames.size(); ++f) {
      const int frame = recording.misfit.frames[f];
      for (int m = 0; m < markers; ++m) {
        const Eigen::Index at = static_cast<Eigen::Index>(f) * markers + m;
        const Eigen::Vector3d measured = model.item().recording.markers.positions[frame].col(m);
        const Eigen::Vector3d difference =
            recording.misfit.observed[at]
                ? Eigen::Vector3d(recording.misfit.residual.segment<3>(3 * at) -
                                  recording.place_offset.col(m))
                : Eigen::Vector3d::Constant(kNotMeasured);
        const double row[] = {static_cast<double>(r),
                              static_cast<double>(frame),
                              model.item().recording.times[frame],
                              static_cast<double>(m),
                              static_cast<double>(recording.fitted[f]),
                              measured[0],
                              measured[1],
                              measured[2],
                              difference[0],
                              difference[1],
                              difference[2]};
        for (size_t k = 0; k < columns.size(); ++k) columns[k].push_back(row[k]);
      }
    }
  }
  const char* names[] = {"recording",      "frame",          "time_s",        "marker",
                         "fitted",         "measured_x_m",   "measured_y_m",  "measured_z_m",
                         "difference_x_m", "difference_y_m", "difference_z_m"};
  CsvTable table;
  for (size_t k = 0; k < columns.size(); ++k)
    table.push_back(
        {names[k], Eigen::Map<Eigen::VectorXd>(columns[k].data(),
                                               static_cast<Eigen::Index>(columns[k].size()))});
  return table;
}

// A prior is strained where the fit is so many of its deviations away.
constexpr double kStrained = 3;

std::vector<std::string> Strains(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                                 const std::vector<RecordingMisfit>& misfits) {
  std::vector<std::string> strains;
  const PredictionStudy& study = problem.study();
  for (size_t k = study.fitted.size(); k < problem.parameters().size(); ++k) {
    const CalibratedParameter& prior = problem.parameters()[k];
    const double away = std::abs(values[static_cast<Eigen::Index>(k)]) / prior.prior_deviation;
    if (away > kStrained)
      strains.push_back(
          fmt::format("{} is {:.1f} deviations of its prior away from 0", prior.name, away));
  }
  for (size_t r = 0; r < misfits.size(); ++r) {
    const std::vector<std::string>& names = study.recordings[r].recording.markers.names;
    for (Eigen::Index m = 0; m < misfits[r].place_offset.cols(); ++m) {
      const Eigen::Vector3d offset = misfits[r].place_offset.col(m);
      if (offset.norm() > kStrained * study.place_deviation)
        strains.push_back(
            fmt::format("{}: the model would have marker {} ({:.1f}, {:.1f}, {:.1f}) mm from where "
                        "it is, in all "
                        "frames alike; place_deviation allows {:.1f} mm",
                        misfits[r].name, names[m], 1e3 * offset.x(), 1e3 * offset.y(),
                        1e3 * offset.z(), 1e3 * study.place_deviation));
    }
  }
  return strains;
}

struct CalibrationStage {
  CalibrationRecord record;
  CsvTable misfit;
};

CalibrationStage Calibrated(const PredictionStudy& study, const ReferenceBody& reference,
                            Progress* progress) {
  const CalibrationProblem problem(study, reference.mesh);
  const Calibration calibration = problem.Fit(problem.Start(), progress);
  CalibrationStage stage;
  CalibrationRecord& record = stage.record;
  // So that the folder of runs can be moved together with the experiments.
  record.experiment = std::filesystem::absolute(study.file)
                          .lexically_proximate(std::filesystem::absolute(study.output));
  record.usable = calibration.usable;
  record.message = calibration.message;
  record.noise = problem.noise();
  record.start_rms = calibration.start_rms;
  record.rms = calibration.rms;
  record.predictions = calibration.predictions;
  for (size_t k = 0; k < calibration.estimates.size(); ++k) {
    const CalibratedParameter& prior = problem.parameters()[k];
    const bool of_model = k < study.fitted.size();
    record.parameters.push_back({prior.name,
                                 of_model                         ? study.fitted[k].unit
                                 : prior.name.ends_with(".clock") ? "s"
                                                                  : "N",
                                 prior.log_scale, calibration.estimates[k]});
  }
  if (calibration.estimates.size() != problem.parameters().size()) return stage;  // no prediction
  progress->Begin("predict", 0);
  const std::vector<RecordingMisfit> misfits = problem.Misfits(calibration.parameters);
  for (size_t r = 0; r < misfits.size(); ++r) {
    record.recordings.push_back(
        {misfits[r].name, study.recordings[r].fitted,
         EstimateMarkerNoise(study.recordings[r], study.recordings[r].frames), misfits[r].in_fit,
         misfits[r].held_out});
  }
  record.strains = Strains(problem, calibration.parameters, misfits);
  stage.misfit = MisfitTable(problem, misfits);
  progress->End();
  return stage;
}

}  // namespace

std::string VerdictName(Verdict verdict) {
  for (const auto& [value, name] : VerdictNames())
    if (value == verdict) return name;
  return "";
}

CalibrationRecord RunCalibration(const PredictionStudy& study, Progress* progress) {
  RunDirectory run(study.output);
  std::map<std::string, std::string> inputs;
  for (const PredictedRecording& item : study.recordings)
    for (const std::filesystem::path& file : RecordingFiles(item.recording))
      inputs[item.name + "/" +
             file.lexically_proximate(item.recording.file.parent_path()).generic_string()] =
          HashFile(file);
  run.Begin(study.configuration, inputs, 0);

  const auto reference = RunStage<ReferenceBody>(
      &run, {"mesh", kMeshVersion, study.configuration.at("mesh"), inputs}, progress,
      [&] {
        progress->Begin("mesh", 0);
        const PredictedRecording& first = study.recordings.front();
        ReferenceBody body = MakeReferenceBody(
            {study.name, first.recording, study.mesh, study.sheet_layers, first.frames.front()});
        progress->End(
            fmt::format("{} nodes, {} tetrahedra", body.mesh.NodeCount(), body.mesh.TetCount()));
        return body;
      },
      SaveReferenceBody, ReadReferenceBody);

  std::map<std::string, std::string> behind = inputs;
  behind["mesh"] = run.ResultHash("mesh");
  CalibrationStage stage = RunStage<CalibrationStage>(
      &run, {"calibration", kCalibrationVersion, study.configuration, behind}, progress,
      [&] { return Calibrated(study, reference, progress); },
      [](const CalibrationStage& value, const std::filesystem::path& folder) {
        WriteFileAtomically(folder / "calibration.json", ToJson(value.record).dump(2) + "\n");
        if (!value.misfit.empty()) SaveCsv(value.misfit, folder / "misfit.csv");
      },
      [](const std::filesystem::path& folder) {
        return CalibrationStage{ReadCalibrationFile(folder / "calibration.json"), {}};
      });
  run.Finish();
  stage.record.mesh = reference.quality;
  return stage.record;
}

FittedRun OpenRun(const std::filesystem::path& run) {
  FittedRun opened;
  opened.record = LoadCalibration(run);
  if (!opened.record.usable) {
    throw InputError(
        fmt::format("{}: its fit is not usable: {}", run.string(), opened.record.message));
  }
  const std::filesystem::path experiment = (run / opened.record.experiment).lexically_normal();
  opened.study = ReadPredictionStudy(Config::Load(experiment));
  if (opened.study.configuration != LoadManifest(run / "manifest.json").configuration) {
    throw InputError(fmt::format("{}: {} has changed since; run `lacuna fit` again", run.string(),
                                 experiment.string()));
  }
  opened.mesh = ReadReferenceBody(FinishedStage(run, "mesh")).mesh;
  opened.values.resize(static_cast<Eigen::Index>(opened.record.parameters.size()));
  for (size_t k = 0; k < opened.record.parameters.size(); ++k)
    opened.values[static_cast<Eigen::Index>(k)] = opened.record.parameters[k].estimate.value;
  return opened;
}

CalibrationRecord LoadCalibration(const std::filesystem::path& run) {
  return ReadCalibrationFile(FinishedStage(run, "calibration") / "calibration.json");
}

}  // namespace lacuna
