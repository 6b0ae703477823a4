#include "report/reaction_curves.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "record/json_vector.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// A component is also drawn over the motion of its grip along it where the range of that motion is
// at least this share of the largest one among the components of its table. Larger: curves over
// small transverse motions are left out; smaller: curves over the noise of a grip that follows
// markers are drawn.
constexpr double kLeastShare = 0.05;
constexpr double kLeastMotion = 1e-9;  // m or rad; smaller ones are rounding errors

CsvTable ReadIfThere(const fs::path& file) { return fs::exists(file) ? ReadCsv(file) : CsvTable(); }

// The rows of each component of each reading of recording `r` in which there is a value.
std::map<std::pair<int, int>, std::vector<int>> RowsOfComponents(const CsvTable& table, size_t r,
                                                                 const Eigen::VectorXd& measured,
                                                                 const fs::path& file) {
  const Eigen::VectorXd& recording = ColumnOf(table, "recording", file);
  const Eigen::VectorXd& reading = ColumnOf(table, "reaction", file);
  const Eigen::VectorXd& component = ColumnOf(table, "component", file);
  std::map<std::pair<int, int>, std::vector<int>> rows;
  for (Eigen::Index row = 0; row < recording.size(); ++row)
    if (recording[row] == static_cast<double>(r) && !std::isnan(measured[row]))
      rows[{static_cast<int>(reading[row]), static_cast<int>(component[row])}].push_back(
          static_cast<int>(row));
  return rows;
}

double RangeOf(const Eigen::VectorXd& values) { return values.maxCoeff() - values.minCoeff(); }

void AppendCurves(const CsvTable& table, const fs::path& file, bool is_torque, size_t r,
                  const FittedRecording& recording, json* curves) {
  if (table.empty()) return;
  const auto column = [&](const char* name) -> const Eigen::VectorXd& {
    return ColumnOf(table, name, file);
  };
  const Eigen::VectorXd& measured = column(is_torque ? "measured_N_m" : "measured_N");
  const Eigen::VectorXd& difference = column(is_torque ? "difference_N_m" : "difference_N");
  const Eigen::VectorXd& motion = column(is_torque ? "rotation_rad" : "displacement_m");
  const auto components = RowsOfComponents(table, r, measured, file);
  double least = kLeastMotion;
  for (const auto& [which, rows] : components)
    least = std::max(least, kLeastShare * RangeOf(motion(rows)));
  for (const auto& [which, rows] : components) {
    const auto [number, component] = which;
    const bool is_known =
        number >= 0 && number < static_cast<int>(recording.reactions.size()) && component >= 0 &&
        component <
            static_cast<int>(recording.reactions[static_cast<size_t>(number)].labels.size());
    if (!is_known)
      throw InputError({file.string()},
                       fmt::format("contains component {} of reading {} of {}, which the fit does "
                                   "not have",
                                   component, number, recording.name));
    const FittedReaction& reaction = recording.reactions[static_cast<size_t>(number)];
    json fitted = json::array();
    for (const int row : rows) fitted.push_back(column("fitted")[row] != 0);
    const Eigen::VectorXd seen = measured(rows), moved = motion(rows);
    curves->push_back({{"reading", number},
                       {"grip", reaction.name},
                       {"quantity", reaction.Quantity()},
                       {"unit", reaction.Unit()},
                       {"component", reaction.labels[static_cast<size_t>(component)]},
                       {"sigma", reaction.deviation},
                       {"time_s", VectorToJson(column("time_s")(rows))},
                       {"fitted", fitted},
                       {"measured", VectorToJson(seen)},
                       {"model", VectorToJson(seen + difference(rows))},
                       {"motion", RangeOf(moved) >= least ? VectorToJson(moved) : json()}});
  }
}

}  // namespace

ReactionTables ReadReactionTables(const fs::path& calibration) {
  return {calibration, ReadIfThere(calibration / "reactions.csv"),
          ReadIfThere(calibration / "torques.csv")};
}

json ReactionCurves(const ReactionTables& tables, size_t r, const FittedRecording& recording) {
  json curves = json::array();
  AppendCurves(tables.forces, tables.folder / "reactions.csv", false, r, recording, &curves);
  AppendCurves(tables.torques, tables.folder / "torques.csv", true, r, recording, &curves);
  return curves;
}

}  // namespace lacuna
