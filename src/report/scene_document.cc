#include "report/scene_document.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/json_number.h"
#include "geometry/thinned_surface.h"
#include "record/json_vector.h"
#include "record/model_errors.h"
#include "record/motion_record.h"
#include "record/packed_array.h"
#include "record/recorded_residuals.h"
#include "record/run_directory.h"
#include "report/reaction_curves.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::optional<StoredMotion> FindMotion(const ReportedModel& model, size_t recording) {
  const fs::path file = MotionFile(model.folder, recording);
  if (!fs::exists(file)) return std::nullopt;
  StoredMotion motion = ReadMotionFile(file);
  if (motion.fit != model.fit) return std::nullopt;
  return motion;
}

// The columns of the residuals that are shown: those nearest to the frames of the motion, or evenly
// spread ones where there is none.
std::vector<int> ShownColumns(const RecordedResiduals& residuals, const StoredMotion* motion) {
  const int count = static_cast<int>(residuals.frames.size());
  if (motion == nullptr) return EvenlySpread(count, kMostShownFrames);
  std::vector<int> columns;
  for (const json& time : motion->times) {
    Eigen::Index nearest = 0;
    (residuals.times.array() - time.get<double>()).abs().minCoeff(&nearest);
    columns.push_back(static_cast<int>(nearest));
  }
  return columns;
}

// The standard deviation that the fit assumed for a component of a point.
double NoiseOf(const CalibrationRecord& record, const FittedRecording& recording) {
  return recording.scan ? recording.scan->patch_noise : record.noise;
}

std::vector<std::string> PointNames(const ReportedModel& model, size_t recording, int points) {
  if (model.comparison && recording < model.comparison->recordings.size())
    return model.comparison->recordings[recording].point_names;
  const FittedRecording& fitted = model.calibration.recordings[recording];
  if (static_cast<int>(fitted.marker_names.size()) == points) return fitted.marker_names;
  std::vector<std::string> names;
  for (int m = 0; m < points; ++m)
    names.push_back(fmt::format("{} {}", fitted.scan ? "patch" : "marker", m));
  return names;
}

json PackPoints(const Eigen::MatrixXd& points) {
  return PackFrames(points, {static_cast<int>(points.rows() / 3), 3});
}

// Numbers from which the page computes, with 16 bits where their steps are no larger than
// `largest_step`, and in single precision otherwise.
json PackSeries(const Eigen::MatrixXd& values, const std::vector<int>& of_frame,
                double largest_step) {
  constexpr double kSteps = 65534;  // of a 16-bit number (record/packed_array.h)
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : values.reshaped()) {  // NaN: not observed
    low = std::fmin(low, value);
    high = std::fmax(high, value);
  }
  if (high - low <= kSteps * largest_step) return PackFrames(values, of_frame);
  return PackFloats(values, of_frame);
}

// The smallest σ of a point, where points have noise of their own, or else `sigma`.
double SmallestSigma(const RecordedResiduals& residuals, double sigma) {
  double smallest = sigma;
  for (const double own : residuals.sigma.reshaped()) smallest = std::fmin(smallest, own);
  return smallest;
}

json PackPositions(const Eigen::MatrixXd& points, double smallest_sigma) {
  constexpr double kLargestStep = 0.05;  // in σ; smaller: less rounding, larger files
  return PackSeries(points, {static_cast<int>(points.rows() / 3), 3},
                    kLargestStep * smallest_sigma);
}

// Whether the noise of some point in some frame differs from that of a typical one: points have
// weights, or patches are means of different numbers of scanned points.
bool PointsHaveOwnNoise(const RecordedResiduals& residuals, double sigma) {
  constexpr double kSame = 1e-6;  // relative; above rounding errors
  return ((residuals.sigma.array() / sigma - 1).abs() > kSame).any();
}

// The rms length that noise alone gives to the points seen in each frame; null where none was seen.
json NoiseOfFrames(const RecordedResiduals& residuals, bool is_scan) {
  json noise = json::array();
  for (Eigen::Index f = 0; f < residuals.sigma.cols(); ++f) {
    double sum = 0;
    int seen = 0;
    for (const double sigma : residuals.sigma.col(f)) {
      if (std::isnan(sigma)) continue;
      sum += sigma * sigma;
      ++seen;
    }
    if (seen == 0) {
      noise.push_back(nullptr);
      continue;
    }
    const double rms = std::sqrt(sum / seen);
    noise.push_back(is_scan ? rms : RmsOfMarkerNoise(rms));
  }
  return noise;
}

// Adds the σ of each point in each frame, and what they give to the rms of a frame.
void AddOwnNoise(const RecordedResiduals& residuals, const std::vector<int>& shown, bool is_scan,
                 double smallest_sigma, json* scene) {
  constexpr double kLargestStep = 1e-3;  // relative to the smallest σ
  const auto pack = [&](const Eigen::MatrixXd& sigmas) {
    return PackSeries(sigmas, {static_cast<int>(sigmas.rows())}, kLargestStep * smallest_sigma);
  };
  (*scene)["points"]["sigmas"] = pack(residuals.sigma(Eigen::all, shown));
  (*scene)["points_series"]["sigmas"] = pack(residuals.sigma);
  (*scene)["series"]["noise_m"] = NoiseOfFrames(residuals, is_scan);
}

json SeriesOf(const RecordedResiduals& residuals, double sigma) {
  json rms = json::array(), fitted = json::array();
  for (Eigen::Index f = 0; f < residuals.times.size(); ++f) {
    double sum = 0;
    int seen = 0;
    for (int m = 0; m < residuals.PointCount(); ++m) {
      const double squared = residuals.difference.col(f).segment<3>(3 * m).squaredNorm();
      if (std::isnan(squared)) continue;
      sum += squared;
      ++seen;
    }
    rms.push_back(seen > 0 ? json(std::sqrt(sum / seen)) : json());
    fitted.push_back(residuals.fitted[static_cast<size_t>(f)] != 0);
  }
  return {{"time_s", VectorToJson(residuals.times)},
          {"fitted", fitted},
          {"rms_m", rms},
          {"sigma_m", sigma}};
}

// The rows of a table whose first column is the number of the recording.
std::vector<int> RowsOf(const CsvTable& table, size_t recording) {
  std::vector<int> rows;
  for (Eigen::Index row = 0; !table.empty() && row < table.front().values.size(); ++row)
    if (table.front().values[row] == static_cast<double>(recording))
      rows.push_back(static_cast<int>(row));
  return rows;
}

// The rows of unexplained_force.csv for one recording; null where there are none.
json ForceOf(const CsvTable& table, size_t recording) {
  const std::vector<int> rows = RowsOf(table, recording);
  if (rows.empty()) return nullptr;
  const auto column = [&](const std::string& name) -> json {
    for (const CsvColumn& one : table)
      if (one.name == name) return VectorToJson(one.values(rows));
    return nullptr;
  };
  const auto axes = [&](const std::string& what, const std::string& unit) -> json {
    return {column(what + "_x_" + unit), column(what + "_y_" + unit), column(what + "_z_" + unit)};
  };
  return {{"time_s", column("time_s")},
          {"force_N", axes("force", "N")},
          {"force_deviation_N", axes("force_deviation", "N")},
          {"torque_N_m", axes("torque", "Nm")},
          {"power_W", column("power_W")}};
}

json SceneOf(const ReportedModel& model, size_t r, const RecordedResiduals& residuals,
             const CsvTable& forces, const json& reactions) {
  const FittedRecording& recording = model.calibration.recordings[r];
  const double sigma = NoiseOf(model.calibration, recording);
  const std::optional<StoredMotion> motion = FindMotion(model, r);
  const std::vector<int> shown = ShownColumns(residuals, motion ? &*motion : nullptr);
  const Eigen::MatrixXd modelled = residuals.measured + residuals.difference;
  const std::vector<std::string> names = PointNames(model, r, residuals.PointCount());
  json fitted = json::array();
  for (const int column : shown)
    fitted.push_back(residuals.fitted[static_cast<size_t>(column)] != 0);
  const double smallest_sigma = SmallestSigma(residuals, sigma);
  json scene = {{"recording", recording.name},
                {"times", VectorToJson(residuals.times(shown))},
                {"fitted", fitted},
                {"up", motion ? motion->up : json()},
                {"surface", motion ? motion->surface : json()},
                {"points",
                 {{"names", names},
                  {"is_scan", recording.scan.has_value()},
                  {"measured", PackPoints(residuals.measured(Eigen::all, shown))},
                  {"model", PackPoints(modelled(Eigen::all, shown))},
                  {"residual", PackPoints(residuals.difference(Eigen::all, shown))},
                  {"sigma", sigma}}},
                {"series", SeriesOf(residuals, sigma)},
                {"points_series",
                 {{"time_s", VectorToJson(residuals.times)},
                  {"names", names},
                  {"measured", PackPositions(residuals.measured, smallest_sigma)},
                  {"model", PackPositions(modelled, smallest_sigma)}}},
                {"force", ForceOf(forces, r)},
                {"reactions", reactions},
                {"notes", motion ? json(motion->notes) : json::array()}};
  if (PointsHaveOwnNoise(residuals, sigma))
    AddOwnNoise(residuals, shown, recording.scan.has_value(), smallest_sigma, &scene);
  return scene;
}

}  // namespace

json SceneDocuments(const ReportedModel& model) {
  json scenes = json::array();
  const fs::path file = FinishedStage(model.folder, "calibration") / "misfit.csv";
  if (!fs::exists(file)) return scenes;  // a model that could not be simulated
  const CsvTable misfit = ReadCsv(file);
  const fs::path force_file = model.folder / "comparison/unexplained_force.csv";
  const CsvTable forces =
      model.comparison && fs::exists(force_file) ? ReadCsv(force_file) : CsvTable();
  const ReactionTables reactions = ReadReactionTables(file.parent_path());
  for (size_t r = 0; r < model.calibration.recordings.size(); ++r) {
    const RecordedResiduals residuals = ReadResiduals(misfit, static_cast<int>(r), file);
    if (!residuals.frames.empty())
      scenes.push_back(SceneOf(model, r, residuals, forces,
                               ReactionCurves(reactions, r, model.calibration.recordings[r])));
  }
  return scenes;
}

json ReconstructionScene(const fs::path& run) {
  const fs::path file = FinishedStage(run, "results") / "shown_motion.json";
  if (!fs::exists(file)) return nullptr;
  const StoredMotion motion = ReadMotionFile(file);
  return {{"recording", motion.recording},
          {"times", motion.times},
          {"fitted", std::vector<bool>(motion.times.size(), true)},
          {"up", motion.up},
          {"surface", motion.surface},
          {"points", motion.points},
          {"series", nullptr},
          {"points_series", nullptr},
          {"force", nullptr},
          {"reactions", json::array()},
          {"notes", motion.notes}};
}

}  // namespace lacuna
