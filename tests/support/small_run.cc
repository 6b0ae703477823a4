#include "support/small_run.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/hash.h"
#include "record/comparison_record.h"
#include "record/csv_table.h"
#include "record/run_directory.h"
#include "support/small_ledger.h"

namespace lacuna {
namespace {

constexpr int kFittedFrames = 30;
constexpr double kSpacing = 0.01;  // s

// Two markers that swing, 0.3 mm beside the prediction; the second was not seen in frame 3.
CsvTable Misfit(const CalibrationRecord& record, const SmallRun& run) {
  std::vector<const char*> names{"recording",      "frame",         "time_s",
                                 "marker",         "fitted",        "measured_x_m",
                                 "measured_y_m",   "measured_z_m",  "difference_x_m",
                                 "difference_y_m", "difference_z_m"};
  if (!run.sigmas.empty()) names.push_back("sigma_m");
  std::vector<std::vector<double>> columns(names.size());
  for (size_t r = 0; r < record.recordings.size(); ++r)
    for (int f = 0; f < kFittedFrames + run.held_out_frames; ++f)
      for (int m = 0; m < 2; ++m) {
        const double fitted = record.recordings[r].fitted && f < kFittedFrames ? 1 : 0;
        const double gap = m == 1 && f == 3 ? kNotMeasured : 3e-4;
        std::vector<double> row{static_cast<double>(r),
                                static_cast<double>(f),
                                kSpacing * f,
                                static_cast<double>(m),
                                fitted,
                                0.03 * (m + 1),
                                0.002 * m,
                                0.001 * f,
                                0,
                                0,
                                gap};
        if (!run.sigmas.empty())
          row.push_back(std::isnan(gap) ? kNotMeasured : run.sigmas[static_cast<size_t>(m)]);
        for (size_t k = 0; k < columns.size(); ++k) columns[k].push_back(row[k]);
      }
  CsvTable table;
  for (size_t k = 0; k < columns.size(); ++k)
    table.push_back(
        {names[k], Eigen::Map<const Eigen::VectorXd>(
                       columns[k].data(), static_cast<Eigen::Index>(columns[k].size()))});
  return table;
}

std::string HashOfFit(const std::filesystem::path& folder) {
  return HashFile(folder / "calibration/calibration.json");
}

}  // namespace

MotionRecord SmallMotion() {
  MotionRecord motion;
  motion.recording = "a";
  motion.times = Eigen::Vector3d(0, 0.1, 0.3);
  motion.up = Eigen::Vector3d::UnitZ();
  motion.triangles = Eigen::Vector3i(0, 1, 2);
  motion.positions = Eigen::MatrixXd::Zero(9, 3);
  motion.positions(3, 0) = motion.positions(7, 1) = 0.02;
  motion.fields = {{"speed", "speed", "m/s", Eigen::MatrixXd::Ones(3, 3)}};
  return motion;
}

void WriteSmallFit(const std::filesystem::path& folder, const SmallRun& run,
                   const CalibrationRecord& record) {
  RunDirectory directory(folder);
  nlohmann::json effects = nlohmann::json::array();
  for (const std::string& effect : run.effects) effects.push_back({{"type", effect}});
  const nlohmann::json configuration = {
      {"name", run.name},
      {"effects", effects},
      {"recordings", {{{"recording", "a"}}}},
      {"material", {{"law", "neo_hookean"}, {"young_modulus", run.young_modulus}}}};
  directory.Begin(configuration, {{"a/markers.csv", run.content}}, 0);
  directory.Store("calibration", "key", [&](const std::filesystem::path& stage) {
    WriteCalibrationFile(record, stage / "calibration.json");
    WriteCsv(Misfit(record, run), stage / "misfit.csv");
  });
  directory.Finish();
  MakeFolder(MotionFile(folder, 0).parent_path());
  MotionRecord motion = SmallMotion();
  motion.fit = HashOfFit(folder);
  WriteMotionFile(motion, MotionFile(folder, 0));
}

void WriteSmallComparison(const std::filesystem::path& folder, const SmallRun& run) {
  ComparisonRecord comparison;
  comparison.fit = HashOfFit(folder);
  for (const char* name : {"a", "b"}) {
    ComparedPart part;
    part.fitted = false;
    part.frames = run.held_out_frames;
    part.error.rms = *name == 'a' ? 3e-4 : 2e-4;
    part.worst_point = 1;
    part.worst_period = WorstPeriod{31, 35, 5, 0.31, 0.35, 4e-4, {}};
    ComparedRecording recording;
    recording.name = name;
    recording.noise = 1e-4;
    recording.point_names = {"root", run.marker};
    recording.parts = {part};
    comparison.recordings.push_back(recording);
  }
  MakeFolder(folder / "comparison");
  WriteComparisonFile(comparison, {}, folder / "comparison/comparison.json");
}

void WriteSmallDiagnosis(const std::filesystem::path& folder, const DiagnosisRecord& diagnosis) {
  const std::filesystem::path file = folder / "diagnosis/diagnosis.json";
  MakeFolder(file.parent_path());
  WriteDiagnosisFile(diagnosis, file);
  const nlohmann::json origin = {{"of", {{"fit", HashOfFit(folder)}}},
                                 {"diagnosis", HashFile(file)}};
  WriteFileAtomically(folder / "diagnosis/of_fit.json", origin.dump());
}

void WriteSmallChain(const std::filesystem::path& folder) {
  Ledger ledger = SmallLedger();
  SmallRun run;
  for (LedgerModel& model : ledger.models) {
    run.name = model.added.empty() ? "bar" : "bar+" + model.added;
    if (!model.added.empty()) run.effects.push_back(model.added);
    model.run = folder / run.name;
    WriteSmallFit(model.run, run, model.record);
    if (model.diagnosis) WriteSmallDiagnosis(model.run, *model.diagnosis);
  }
  WriteSmallComparison(folder / "bar", {});
  WriteLedgerFile(ledger, folder / "bar");
}

}  // namespace lacuna
