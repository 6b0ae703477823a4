#include "record/motion_record.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/hash.h"
#include "core/json_file.h"
#include "geometry/thinned_surface.h"
#include "record/json_hash.h"
#include "record/json_vector.h"
#include "record/packed_array.h"
#include "record/schema_version.h"

namespace lacuna {
namespace {

using nlohmann::json;

constexpr int kSchemaVersion = 1;

json FieldToJson(const ShownField& field) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : field.values.reshaped()) {
    low = std::fmin(low, value);
    high = std::fmax(high, value);
  }
  return {{"name", field.name},
          {"label", field.label},
          {"unit", field.unit},
          {"on", "nodes"},
          {"diverging", low < 0 && high > 0},
          {"low", NumberOrNull(low)},
          {"high", NumberOrNull(high)},
          {"values", PackFrames(field.values, {static_cast<int>(field.values.rows())})}};
}

json SurfaceToJson(const MotionRecord& record) {
  const Eigen::Index vertices = record.positions.rows() / 3;
  CHECK_EQ(record.positions.cols(), record.times.size());
  CHECK(record.triangles.size() == 0 || record.triangles.maxCoeff() < vertices);
  json fields = json::array();
  for (const ShownField& field : record.fields) {
    CHECK_EQ(field.values.rows(), vertices) << field.name;
    CHECK_EQ(field.values.cols(), record.times.size()) << field.name;
    fields.push_back(FieldToJson(field));
  }
  return {{"triangles", PackTriangles(record.triangles)},
          {"positions", PackFrames(record.positions, {static_cast<int>(vertices), 3})},
          {"fields", fields}};
}

// The scans as one array, filled up with NaN where a frame has fewer points than another.
json ScansToJson(const std::vector<Eigen::Matrix3Xd>& scans, std::vector<std::string>* notes) {
  if (scans.empty()) return nullptr;
  Eigen::Index most = 0;
  for (const Eigen::Matrix3Xd& scan : scans) most = std::max(most, scan.cols());
  const Eigen::Index shown = std::min<Eigen::Index>(most, kMostShownPoints);
  if (shown < most)
    notes->push_back(
        fmt::format("At most {} of up to {} points of each scan are drawn.", shown, most));
  Eigen::MatrixXd points = Eigen::MatrixXd::Constant(
      3 * shown, static_cast<Eigen::Index>(scans.size()), std::numeric_limits<double>::quiet_NaN());
  for (size_t f = 0; f < scans.size(); ++f) {
    const std::vector<int> kept =
        EvenlySpread(static_cast<int>(scans[f].cols()), static_cast<int>(shown));
    for (size_t k = 0; k < kept.size(); ++k)
      points.col(static_cast<Eigen::Index>(f)).segment<3>(3 * static_cast<Eigen::Index>(k)) =
          scans[f].col(kept[k]);
  }
  return {{"names", json::array()},
          {"is_scan", true},
          {"measured", PackFrames(points, {static_cast<int>(shown), 3})},
          {"model", nullptr},
          {"residual", nullptr},
          {"sigma", nullptr}};
}

}  // namespace

std::filesystem::path MotionFile(const std::filesystem::path& run, size_t recording) {
  return run / "shown_motion" / (std::to_string(recording) + ".json");
}

void WriteMotionFile(const MotionRecord& record, const std::filesystem::path& file) {
  CHECK(record.scans.empty() ||
        static_cast<Eigen::Index>(record.scans.size()) == record.times.size());
  std::vector<std::string> notes = record.notes;
  const json points = ScansToJson(record.scans, &notes);
  json document{{"schema_version", kSchemaVersion},
                {"fit", record.fit},
                {"recording", record.recording},
                {"times", VectorToJson(record.times)},
                {"up", record.up ? VectorToJson(*record.up) : json()},
                {"surface", SurfaceToJson(record)},
                {"points", points},
                {"notes", notes}};
  document["hash"] = HashBytes(document.dump());
  WriteFileAtomically(file, document.dump() + "\n");
}

StoredMotion ReadMotionFile(const std::filesystem::path& file) {
  const auto read = [&](const json& document) {
    return NamingWhere(file.string(), [&] {
      RequireSchemaVersion(document, kSchemaVersion, "lacuna compare");
      // Files of earlier versions have no hash.
      if (document.contains("hash") && document["hash"] != HashWithout(document, {"/hash"}))
        throw InputError({file.string()}, "is damaged; `lacuna compare` writes it again");
      return StoredMotion{document.at("fit"),
                          document.at("recording"),
                          document.at("times"),
                          document.at("up"),
                          document.at("surface"),
                          document.at("points"),
                          document.at("notes").get<std::vector<std::string>>()};
    });
  };
  return ReadJsonFile(file, read, "a motion");
}

}  // namespace lacuna
