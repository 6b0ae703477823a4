#include "comparison/planted_run.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "analysis/residual_statistics.h"
#include "comparison/run_comparison.h"
#include "core/error.h"
#include "experiment/reference_body.h"
#include "record/run_directory.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

using nlohmann::json;

// The seconds for which the object of a recording moves.
double Moving(size_t recording, double time) {
  return std::max(0.0, time - 0.3 - 0.05 * static_cast<double>(recording));
}

json EmptyMeasure() {
  return {{"frames", 1},      {"points", 1},           {"rms_m", 0.0},
          {"largest_m", 0.0}, {"rms_over_sigma", 0.0}, {"rms_at_measured_places_m", 0.0}};
}

json CalibrationOf(const PlantedRun& planted) {
  json recordings = json::array();
  for (size_t r = 0; r < planted.recordings.size(); ++r)
    recordings.push_back({{"name", planted.recordings[r]},
                          {"fitted", r == 0},
                          {"noise_m", PlantedRun::kNoise},
                          {"in_fit", EmptyMeasure()},
                          {"held_out", EmptyMeasure()}});
  return {{"schema_version", 4},
          {"experiment", "../experiment.yaml"},
          {"usable", true},
          {"message", ""},
          {"noise_m", PlantedRun::kNoise},
          {"time_step_s", 0.005},
          {"step_error_over_sigma", 0},
          {"rms_before", 2.0},
          {"rms_after", 1.0},
          {"predictions", 3},
          {"parameters", json::array()},
          {"held", json::array()},
          {"recordings", recordings},
          {"prior_conflicts", json::array()}};
}

CsvTable MisfitOf(const PlantedRun& planted) {
  constexpr int kMarkers = PlantedRun::kMarkers;
  const char* titles[] = {"recording",      "frame",          "time_s",         "marker",
                          "fitted",         "measured_x_m",   "measured_y_m",   "measured_z_m",
                          "difference_x_m", "difference_y_m", "difference_z_m", "along_normal_m",
                          "sigma_m"};
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0, 1);
  std::vector<std::vector<double>> columns(std::size(titles));
  for (size_t r = 0; r < planted.recordings.size(); ++r) {
    for (int f = 0; f < PlantedRun::kFrames; ++f) {
      const double time = 0.01 * f, moving = Moving(r, time);
      for (int m = 0; m < kMarkers; ++m) {
        const bool seen = m != kMarkers - 1 || f % 10 != 0;
        const double sigma = planted.noise(m);
        const bool is_fitted = r == 0 && f < PlantedRun::kFittedFrames;
        std::vector<double> row{1.0 * r, 1.0 * f, time, 1.0 * m, is_fitted ? 1.0 : 0.0};
        const double x = 0.02 * (planted.is_mirrored && r == 1 ? kMarkers - 1 - m : m);
        const double swing = planted.is_mirrored ? x / 0.06 : 1;
        const Eigen::Vector3d place(x, 0, 0.02 * swing * std::sin(8 * moving));
        for (int axis = 0; axis < 3; ++axis)
          row.push_back(seen ? place[axis] + sigma * normal(random) : kUnknown);
        for (int axis = 0; axis < 3; ++axis)
          row.push_back(seen ? planted.error(f, m)[axis] + sigma * normal(random) : kUnknown);
        row.push_back(kUnknown);
        row.push_back(seen ? sigma : kUnknown);
        for (size_t k = 0; k < columns.size(); ++k) columns[k].push_back(row[k]);
      }
    }
  }
  CsvTable table;
  for (size_t k = 0; k < columns.size(); ++k)
    table.push_back(
        {titles[k], Eigen::Map<Eigen::VectorXd>(columns[k].data(),
                                                static_cast<Eigen::Index>(columns[k].size()))});
  return table;
}

// The recording of this number, with its markers in this order.
void WriteRecording(const std::filesystem::path& folder, const CsvTable& misfit, int number,
                    const std::vector<const char*>& names) {
  std::filesystem::create_directory(folder);
  std::ofstream(folder / "recording.yaml") << R"(schema_version: 1
name: a
length_unit: m
density: 1000 kg/m^3
frames:
  kind: markers
  file: tracks.csv
  columns: {time: t, x: "*_x", y: "*_y", z: "*_z"}
  marker_places:
    - {name: root, position: [0 mm, 0 mm, 0 mm]}
    - {name: left, position: [20 mm, 0 mm, 0 mm]}
    - {name: right, position: [40 mm, 0 mm, 0 mm]}
    - {name: tip, position: [60 mm, 0 mm, 0 mm]}
fixed: [{name: clamp, half_space: {point: [1 mm, 0 mm, 0 mm], normal: [-1, 0, 0]}}]
reference: {from: mesh, file: box.off, length_unit: m}
)";
  std::ofstream(folder / "box.off")
      << "OFF\n8 12 0\n0 0 0\n0.06 0 0\n0.06 0.02 0\n0 0.02 0\n0 0 0.02\n0.06 0 0.02\n"
         "0.06 0.02 0.02\n0 0.02 0.02\n3 0 2 1\n3 0 3 2\n3 4 5 6\n3 4 6 7\n3 0 1 5\n3 0 5 4\n"
         "3 1 2 6\n3 1 6 5\n3 2 3 7\n3 2 7 6\n3 3 0 4\n3 3 4 7\n";
  std::ofstream tracks(folder / "tracks.csv");
  tracks.precision(17);
  tracks << "t";
  for (const char* name : names)
    for (const char axis : {'x', 'y', 'z'}) tracks << "," << name << "_" << axis;
  constexpr int kRows = PlantedRun::kFrames * PlantedRun::kMarkers;
  for (int row = number * kRows; row < (number + 1) * kRows; ++row) {
    if (row % PlantedRun::kMarkers == 0) tracks << "\n" << misfit[2].values[row];
    for (int axis = 0; axis < 3; ++axis) {
      tracks << ",";
      const double value = misfit[5 + axis].values[row];
      if (!std::isnan(value)) tracks << value;
    }
  }
  tracks << "\n";
}

}  // namespace

Eigen::Vector3d LowMarker(int frame, int marker) {
  return {0, 0, marker == 2 && frame >= 90 && frame < 110 ? -1e-3 : 0};
}

CsvTable WriteRun(const std::filesystem::path& run, const PlantedRun& planted) {
  json entries = json::array();
  for (size_t r = 0; r < planted.recordings.size(); ++r)
    entries.push_back({{"name", planted.recordings[r]}, {"hold", {{"release", 0.3 + 0.05 * r}}}});
  const CsvTable misfit = MisfitOf(planted);
  RunDirectory directory(run);
  directory.Begin({{"recordings", entries}}, {}, 0);
  directory.Store("calibration", "key", [&](const std::filesystem::path& folder) {
    std::ofstream(folder / "calibration.json") << CalibrationOf(planted).dump(2);
    WriteCsv(misfit, folder / "misfit.csv");
  });
  directory.Store("mesh", "key", [](const std::filesystem::path& folder) {
    ReferenceBody body;
    body.mesh = BoxMesh({0, 0, 0}, {0.06, 0.02, 0.02}, {3, 1, 1});
    WriteReferenceBody(body, folder);
  });
  directory.Finish();
  return misfit;
}

void WriteExperiment(const std::filesystem::path& folder, const CsvTable& misfit, bool has_second) {
  std::ofstream(folder / "experiment.yaml") << R"(schema_version: 1
name: e
output: run
mesh: {max_volume: 1000 mm^3}
material: {law: neo_hookean, young_modulus: 0.1 MPa, poisson_ratio: 0.4}
motion: {time_step: 5 ms}
recordings:
  - {name: a, recording: recording, fit_until: 0.795 s,
     hold: {release: 0.3 s, region: {half_space: {point: [50 mm, 0 mm, 0 mm], normal: [1, 0, 0]}}}}
)";
  if (has_second) {
    std::ofstream(folder / "experiment.yaml", std::ios::app)
        << "  - {name: b, recording: second, fitted: false,\n"
           "     hold: {release: 0.35 s, region: {half_space: {point: [50 mm, 0 mm, 0 mm],\n"
           "                                                  normal: [1, 0, 0]}}}}\n";
    WriteRecording(folder / "second", misfit, 1, {"tip", "right", "left", "root"});
  }
  WriteRecording(folder / "recording", misfit, 0, {"root", "left", "right", "tip"});
}

std::string WhyNotCompared(const std::filesystem::path& run) {
  try {
    CompareRun(run);
  } catch (const InputError& problem) {
    return problem.what();
  }
  return "";
}

}  // namespace lacuna
