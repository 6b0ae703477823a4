#include "record/run_record.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/json_file.h"
#include "core/json_number.h"
#include "core/npy.h"
#include "record/csv_table.h"

namespace lacuna {
namespace {

using nlohmann::json;

constexpr int kSchemaVersion = 1;
constexpr char kRecordName[] = "record.json";
constexpr char kFramesName[] = "frames.csv";
constexpr char kPointResidualsName[] = "point_residuals.npy";

// NaN, "not measured", becomes null; no measure may be infinite.
json FromNumber(double value) {
  CHECK(!std::isinf(value)) << "an infinite measure cannot be recorded";
  return NumberOrNull(value);
}

json FromVector(const Eigen::Vector3d& v) {
  return {FromNumber(v.x()), FromNumber(v.y()), FromNumber(v.z())};
}
Eigen::Vector3d ToVector(const json& value) {
  return {NumberOr(value.at(0)), NumberOr(value.at(1)), NumberOr(value.at(2))};
}

// The numbers of a frame with their names in both files.
struct FrameNumber {
  const char* name;
  double FrameRecord::*value;
};
constexpr FrameNumber kFrameNumbers[] = {
    {"time_s", &FrameRecord::time},
    {"residual_m", &FrameRecord::residual},
    {"residual_mean_m", &FrameRecord::residual_mean},
    {"relative_residual", &FrameRecord::relative_residual},
    {"surface_distance_mean_m", &FrameRecord::surface_distance_mean},
    {"surface_distance_rms_m", &FrameRecord::surface_distance_rms},
    {"surface_distance_max_m", &FrameRecord::surface_distance_max},
    {"relative_surface_distance", &FrameRecord::relative_surface_distance},
};

json FromStatus(const SolverStatus& status) {
  return {{"usable", status.usable},
          {"status", status.status},
          {"message", status.message},
          {"iterations", status.iterations}};
}
SolverStatus ToStatus(const json& value) {
  return {value.at("usable"), value.at("status"), value.at("message"), value.at("iterations")};
}

json FromFrame(const FrameRecord& frame) {
  json value{{"frame", frame.frame}};
  for (const FrameNumber& number : kFrameNumbers) {
    value[number.name] = FromNumber(frame.*number.value);
  }
  value["force_resultant_N"] = FromVector(frame.force_resultant);
  value["force_resultant_deviation_N"] = FromVector(frame.force_resultant_deviation);
  value["torque_resultant_Nm"] = FromVector(frame.torque_resultant);
  value["solver"] = FromStatus(frame.solver);
  return value;
}
FrameRecord ToFrame(const json& value) {
  FrameRecord frame;
  frame.frame = value.at("frame");
  for (const FrameNumber& number : kFrameNumbers) {
    frame.*number.value = NumberOr(value.at(number.name));
  }
  frame.force_resultant = ToVector(value.at("force_resultant_N"));
  frame.force_resultant_deviation = ToVector(value.at("force_resultant_deviation_N"));
  frame.torque_resultant = ToVector(value.at("torque_resultant_Nm"));
  frame.solver = ToStatus(value.at("solver"));
  return frame;
}

constexpr std::pair<RunForces, const char*> kForces[] = {
    {RunForces::kNone, "none"}, {RunForces::kKnown, "known"}, {RunForces::kFitted, "fitted"}};

const char* NameOfForces(RunForces forces) {
  for (const auto& [value, name] : kForces)
    if (value == forces) return name;
  LOG(FATAL) << "forces without a name";
}
// Records of earlier versions do not name them.
RunForces ForcesNamed(const std::string& name) {
  for (const auto& [value, known] : kForces)
    if (known == name) return value;
  return RunForces::kFitted;
}

json FromMesh(const MeshRecord& mesh) {
  return {{"node_count", mesh.node_count},
          {"tet_count", mesh.tet_count},
          {"order", mesh.order},
          {"volume_m3", FromNumber(mesh.volume)},
          {"smallest_angle_rad", FromNumber(mesh.smallest_angle)},
          {"largest_radius_edge_ratio", FromNumber(mesh.largest_radius_edge_ratio)}};
}
MeshRecord ToMesh(const json& value) {
  return {value.at("node_count"),
          value.at("tet_count"),
          value.at("order"),
          NumberOr(value.at("volume_m3")),
          NumberOr(value.at("smallest_angle_rad")),
          NumberOr(value.at("largest_radius_edge_ratio"))};
}

CsvTable FrameTable(const std::vector<FrameRecord>& frames) {
  const auto column = [&frames](const std::string& name, const auto& value) {
    CsvColumn result{name, Eigen::VectorXd(static_cast<Eigen::Index>(frames.size()))};
    std::transform(frames.begin(), frames.end(), result.values.begin(), value);
    return result;
  };
  CsvTable table{column("frame", [](const FrameRecord& f) { return double(f.frame); })};
  for (const FrameNumber& number : kFrameNumbers) {
    table.push_back(column(number.name, [&](const FrameRecord& f) { return f.*number.value; }));
  }
  for (int k = 0; k < 3; ++k) {
    table.push_back(column(fmt::format("force_{}_N", "xyz"[k]),
                           [k](const FrameRecord& f) { return f.force_resultant[k]; }));
  }
  for (int k = 0; k < 3; ++k) {
    table.push_back(column(fmt::format("force_{}_deviation_N", "xyz"[k]),
                           [k](const FrameRecord& f) { return f.force_resultant_deviation[k]; }));
  }
  for (int k = 0; k < 3; ++k) {
    table.push_back(column(fmt::format("torque_{}_Nm", "xyz"[k]),
                           [k](const FrameRecord& f) { return f.torque_resultant[k]; }));
  }
  table.push_back(column("usable", [](const FrameRecord& f) { return f.solver.usable ? 1. : 0.; }));
  return table;
}

}  // namespace

bool RunRecord::IsUsable() const {
  return !frames.empty() && frames_not_tried == 0 &&
         std::all_of(frames.begin(), frames.end(),
                     [](const FrameRecord& frame) { return frame.solver.usable; }) &&
         std::all_of(stages.begin(), stages.end(),
                     [](const auto& stage) { return stage.second.usable; });
}

void WriteRunRecord(const RunRecord& record, const std::filesystem::path& folder) {
  const bool has_points = record.point_residuals.size() > 0;
  if (has_points) {
    CHECK_EQ(record.point_residuals.cols(), static_cast<Eigen::Index>(record.frames.size()));
  }
  json document{{"schema_version", kSchemaVersion},
                {"recording", record.recording},
                {"object_size_m", FromNumber(record.object_size)},
                {"animation_residual_m", FromNumber(record.animation_residual)},
                {"relative_animation_residual", FromNumber(record.relative_animation_residual)},
                {"mesh", FromMesh(record.mesh)},
                {"forces", NameOfForces(record.forces)},
                {"frames", json::array()},
                {"frames_not_tried", record.frames_not_tried},
                {"stages", json::object()},
                {"measures", json::object()},
                {"warnings", record.warnings},
                {"has_point_residuals", has_points}};
  for (const FrameRecord& frame : record.frames) document["frames"].push_back(FromFrame(frame));
  for (const auto& [stage, status] : record.stages) document["stages"][stage] = FromStatus(status);
  for (const auto& [name, value] : record.measures) document["measures"][name] = FromNumber(value);

  if (has_points) WriteNpy(folder / kPointResidualsName, record.point_residuals);
  WriteCsv(FrameTable(record.frames), folder / kFramesName);
  WriteFileAtomically(folder / kRecordName,
                      document.dump(2, ' ', false, json::error_handler_t::replace) + "\n");
}

RunRecord ReadRunRecord(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kRecordName;
  const auto read = [&](const json& document) {
    RunRecord record;
    const int version = document.at("schema_version");
    if (version != kSchemaVersion) {
      throw InputError({file.string()},
                       fmt::format("has schema_version {}; expected {}", version, kSchemaVersion));
    }
    record.recording = document.at("recording");
    record.object_size = NumberOr(document.at("object_size_m"));
    record.animation_residual = NumberOr(document.at("animation_residual_m"));
    record.relative_animation_residual = NumberOr(document.at("relative_animation_residual"));
    record.mesh = ToMesh(document.at("mesh"));
    record.forces = ForcesNamed(document.value("forces", ""));
    record.frames_not_tried = document.value("frames_not_tried", 0);
    for (const json& frame : document.at("frames")) record.frames.push_back(ToFrame(frame));
    for (const auto& [stage, status] : document.at("stages").items()) {
      record.stages[stage] = ToStatus(status);
    }
    for (const auto& [name, value] : document.at("measures").items()) {
      record.measures[name] = NumberOr(value);
    }
    document.at("warnings").get_to(record.warnings);
    if (document.at("has_point_residuals").get<bool>()) {
      record.point_residuals = ReadNpyMatrix(folder / kPointResidualsName);
    }
    return record;
  };
  const RunRecord record = ReadJsonFile(file, read, "a valid record");
  if (record.point_residuals.size() > 0 &&
      record.point_residuals.cols() != static_cast<Eigen::Index>(record.frames.size())) {
    throw InputError({(folder / kPointResidualsName).string()},
                     fmt::format("has {} columns for {} frames", record.point_residuals.cols(),
                                 record.frames.size()));
  }
  return record;
}

}  // namespace lacuna
