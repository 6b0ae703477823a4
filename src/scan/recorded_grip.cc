#include "scan/recorded_grip.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "geometry/rotation.h"
#include "geometry/smooth_path.h"
#include "scan/column_units.h"
#include "scan/time_series.h"
#include "scan/yaml_format.h"

namespace lacuna {
namespace {

void CheckMarkers(const Config& item, const std::vector<std::string>& chosen,
                  const std::vector<std::string>& names) {
  if (names.empty()) {
    item.Fail("follows_markers", "the frames of this recording are not of kind markers");
  }
  for (const std::string& name : chosen) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    item.Fail("follows_markers",
              fmt::format("the recording has no marker \"{}\"; its markers are {}", name,
                          fmt::join(names, ", ")));
  }
}

// Chooses of each rotation vector the equal one, which differs by full turns about the same axis,
// that is nearest to that of the row before: robots give vectors of at most 180°, which change
// their sign where the angle passes that.
void MakeContinuous(Eigen::Matrix3Xd* rotations) {
  constexpr double kTurn = 2 * std::numbers::pi;
  for (Eigen::Index k = 1; k < rotations->cols(); ++k) {
    const Eigen::Vector3d before = rotations->col(k - 1), own = rotations->col(k);
    const Eigen::Vector3d axis = (own.isZero(0) ? before : own).normalized();
    rotations->col(k) += kTurn * std::round((before - own).dot(axis) / kTurn) * axis;
  }
}

// Which way it turned in between is not known where two rows are too far apart.
void RequireContinuousTurn(const Config& turn, const DelimitedTable& table,
                           const Eigen::Matrix3Xd& rotations) {
  for (Eigen::Index k = 1; k < rotations.cols(); ++k)
    if ((rotations.col(k) - rotations.col(k - 1)).norm() > std::numbers::pi)
      turn.Fail("x", PlaceOfRow(table, k) +
                         ": the rotation vector changes by more than 180° from the row before; it "
                         "must be continuous, with enough rows");
}

// The names of columns that are given by name or number; empty where the table has none.
std::vector<std::string> NamesOfColumns(const DelimitedTable& table,
                                        const std::vector<std::string>& columns) {
  std::vector<std::string> names;
  if (table.header.empty()) return names;
  for (const std::string& column : columns)
    names.push_back(table.header[static_cast<size_t>(RequireColumn(table, column))]);
  return names;
}

void ReadPath(const Config& path, const DataLocation& data, const FrameData& frames,
              RecordedGrip* grip) {
  const ColumnUnit unit = ReadColumnUnit(path, "length_unit", kLength, data.length_unit);
  const TimeSeries series = ReadVectorSeries(path, data, frames, unit, Rows::kAll);
  grip->motion = GripMotion::kGiven;
  grip->file = series.table.file;
  grip->times = series.times;
  grip->displacements = series.values.colwise() - Eigen::Vector3d(series.values.col(0));
  const std::optional<Config> turn = path.OptionalChild("turn");
  if (!turn) return;
  if (path.Has("from")) turn->Fail("", "needs a `file`: no turn is read from headers");
  const double radian = ReadUnit(*turn, "unit", kAngle, "rad");
  const std::vector<std::string> turns = {turn->Text("x"), turn->Text("y"), turn->Text("z")};
  grip->rotations = ColumnsOf(series.table, turns, radian);
  RefuseOtherUnits(series.table, turns, radian, kAngle, "unit");
  if (!grip->rotations.allFinite()) {
    turn->Fail("x", grip->file.string() + ": a row of the turn is not finite");
  }
  MakeContinuous(&grip->rotations);
  RequireContinuousTurn(*turn, series.table, grip->rotations);
  grip->pivot = turn->Vector("about", kLength);
  grip->turn_columns = NamesOfColumns(series.table, turns);
  grip->turns_in_radians = radian == 1;
}

// The displacement (m) and the rotation vector (rad) of a given path at one time.
struct PathPose {
  Eigen::Vector3d displacement;
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
};

PathPose PoseAt(const RecordedGrip& grip, double time) {
  const std::span<const double> times(grip.times.data(), static_cast<size_t>(grip.times.size()));
  const auto at = [&](const Eigen::Matrix3Xd& rows) {
    return SmoothPath(times,
                      [&rows](size_t k) -> Eigen::Vector3d {
                        return rows.col(static_cast<Eigen::Index>(k));
                      })
        .At(time);
  };
  PathPose pose{at(grip.displacements)};
  if (grip.rotations.cols() > 0) pose.rotation = at(grip.rotations);
  return pose;
}

// The rigid motion from one pose of the grip to another.
Eigen::Isometry3d MotionBetween(const RecordedGrip& grip, const PathPose& from,
                                const PathPose& to) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.translate(to.displacement - from.displacement);
  if (grip.rotations.cols() == 0) return motion;
  motion.translate(grip.pivot);
  motion.rotate(RotationBy(to.rotation) * RotationBy(from.rotation).transpose());
  motion.translate(-grip.pivot);
  return motion;
}

}  // namespace

Eigen::Isometry3d MotionAt(const RecordedGrip& grip, double time) {
  return MotionAt(grip, time, grip.times[0]);
}

Eigen::Isometry3d MotionAt(const RecordedGrip& grip, double time, double since) {
  return MotionBetween(grip, PoseAt(grip, since), PoseAt(grip, time));
}

PathRange RangeOfPath(const RecordedGrip& grip) {
  PathRange range;
  for (const auto displacement : grip.displacements.colwise())
    range.shift = std::max(range.shift, displacement.norm());
  for (const auto rotation : grip.rotations.colwise())
    range.turn = std::max(range.turn, AngleBetween(grip.rotations.col(0), rotation));
  return range;
}

PlacementDeviation ReadPlacement(const Config& config, AxisSet axes) {
  const std::optional<Config> entry = config.OptionalChild("placement");
  if (!entry) return {};
  const PlacementDeviation placement{entry->Quantity("shift_deviation", kLength, kNotNegative, 0),
                                     entry->Quantity("turn_deviation", kAngle, kNotNegative, 0)};
  if (placement.IsExact())
    config.Fail("placement", "needs a shift_deviation or a turn_deviation above 0");
  if (!axes.IsAll())
    config.Fail("placement",
                "cannot be combined with `directions`: the part is not held along all "
                "axes");
  return placement;
}

std::string WithPlacement(std::string mapping, const PlacementDeviation& placement) {
  if (placement.IsExact()) return mapping;
  mapping.pop_back();
  return mapping + fmt::format(", placement: {{shift_deviation: {} m, turn_deviation: {} rad}}}}",
                               placement.shift, placement.turn);
}

std::vector<RecordedGrip> ReadGrips(const Config& config, const DataLocation& data,
                                    const FrameData& frames,
                                    const std::vector<std::string>& marker_names) {
  std::vector<RecordedGrip> grips;
  for (const Config& item : config.Items("gripped")) {
    RecordedGrip grip;
    grip.region = ReadRegion(item, data.folder, fmt::format("grip {}", grips.size() + 1));
    grip.markers = item.Texts("follows_markers");
    const std::optional<Config> path = item.OptionalChild("path");
    if (!grip.markers.empty()) {
      if (path) item.Fail("path", "the grip already follows markers");
      CheckMarkers(item, grip.markers, marker_names);
      grip.motion = GripMotion::kFollowsMarkers;
    } else if (path) {
      ReadPath(*path, data, frames, &grip);
    } else {
      item.Choice<int>("follows", {{"scan", 0}}, "scan");
    }
    grip.deforms = item.Flag("deforms", false);
    grip.axes = ReadDirections(item);
    if (!grip.axes.IsAll() && (!path || grip.rotations.cols() > 0))
      item.Fail("directions", path ? "cannot be combined with a `turn` of the path"
                                   : "needs a `path`: a part that follows markers or a scan is "
                                     "held along all axes");
    grip.placement = ReadPlacement(item, grip.axes);
    if (grip.deforms && path) item.Fail("deforms", "a grip that moves along a path is rigid");
    grips.push_back(std::move(grip));
  }
  return grips;
}

namespace {

std::string DescribeRange(const RecordedGrip& grip) {
  const PathRange range = RangeOfPath(grip);
  std::string text = fmt::format("by up to {:.4g} mm", 1e3 * range.shift);
  if (grip.rotations.cols() > 0)
    text += fmt::format(" and {:.4g}°", range.turn * 180 / std::numbers::pi);
  return text + " since its first row";
}

}  // namespace

std::string DescribeGrip(const RecordedGrip& grip) {
  std::string text = fmt::format("{}: {}", grip.region.name, DescribeRegion(grip.region));
  if (grip.motion == GripMotion::kGiven)
    return text + ", moves along a given path, " + DescribeRange(grip) +
           (grip.axes.IsAll() ? "" : ", held along " + grip.axes.Names() + " only");
  text += grip.motion == GripMotion::kFollowsScan
              ? ", follows the scan"
              : fmt::format(", follows the markers {}", fmt::join(grip.markers, ", "));
  return text + (grip.deforms ? ", which may deform" : "");
}

std::string WriteGrip(const std::filesystem::path& folder, const RecordedGrip& grip,
                      size_t number) {
  std::string item =
      WithPlacement(WithDirections(FormatRegion(grip.region), grip.axes), grip.placement);
  item.pop_back();
  if (grip.deforms) item += ", deforms: true";
  if (grip.motion == GripMotion::kFollowsScan) return item + "}";
  if (grip.motion == GripMotion::kFollowsMarkers)
    return item + fmt::format(", follows_markers: [\"{}\"]}}", fmt::join(grip.markers, "\", \""));
  const std::string name = fmt::format("grip{}.csv", number);
  const bool turns = grip.rotations.cols() > 0;
  Eigen::MatrixXd path(turns ? 6 : 3, grip.times.size());
  path.topRows<3>() = grip.displacements;
  std::vector<std::string> columns = {"x", "y", "z"};
  std::string turn;
  if (turns) {
    path.bottomRows<3>() = grip.rotations;
    columns.insert(columns.end(), {"rx", "ry", "rz"});
    turn = fmt::format(", turn: {{x: rx, y: ry, z: rz, about: {}}}", FormatVector(grip.pivot, "m"));
  }
  WriteTimeSeries(folder / name, grip.times, path, columns);
  return item +
         fmt::format(", path: {{file: {}, time: time, x: x, y: y, z: z, length_unit: m{}}}}}", name,
                     turn);
}

}  // namespace lacuna
