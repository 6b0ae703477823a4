#include "scan/known_forces.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/npy.h"
#include "geometry/hermite.h"
#include "geometry/rotation.h"
#include "scan/delimited_table.h"

namespace lacuna {
namespace {

struct TimeSeries {
  DelimitedTable table;     // that it was read from
  Eigen::VectorXd times;    // s
  Eigen::Matrix3Xd values;  // 3 × k, SI
};

// The SI value of one `unit` of that dimension, e.g. 1e-3 for "mm".
double ReadUnit(const Config& config, const std::string& key, const Dimension& dimension,
                const std::string& default_unit) {
  const std::string unit = config.Text(key, default_unit);
  try {
    return ParseQuantity("1 " + unit, dimension);
  } catch (const std::invalid_argument& problem) {
    config.Fail(key, problem.what());
  }
}

DelimitedTable ReadTableOrArray(const std::filesystem::path& file) {
  if (file.extension() != ".npy") return ReadDelimitedTable(file);
  DelimitedTable table;
  table.file = file;
  table.values = ReadNpyMatrix(file);
  return table;
}

// Three columns of a table, as rows.
Eigen::Matrix3Xd VectorColumns(const DelimitedTable& table, const std::array<std::string, 3>& names,
                               double unit) {
  Eigen::Matrix3Xd vectors(3, table.values.rows());
  for (int axis = 0; axis < 3; ++axis)
    vectors.row(axis) = unit * table.values.col(RequireColumn(table, names[axis])).transpose();
  return vectors;
}

// Columns `time`, `x`, `y`, `z`; without a time there must be one row for each frame.
TimeSeries ReadSeries(const Config& config, const Recording& recording,
                      const std::vector<double>& file_times, double unit) {
  const std::filesystem::path file = recording.data_folder / config.Text("file");
  TimeSeries series;
  series.table = ReadTableOrArray(file);
  const DelimitedTable& table = series.table;
  const std::string time = config.Text("time", "");
  series.values = VectorColumns(
      table, {config.Text("x", "1"), config.Text("y", "2"), config.Text("z", "3")}, unit);
  if (!time.empty()) {
    series.times =
        ReadUnit(config, "time_unit", kTime, "s") * table.values.col(RequireColumn(table, time));
  } else if (table.values.rows() == static_cast<Eigen::Index>(file_times.size())) {
    series.times = Eigen::Map<const Eigen::VectorXd>(file_times.data(), file_times.size());
  } else {
    config.Fail("file", fmt::format("{} has {} rows for {} frames; name its column `time`",
                                    file.string(), table.values.rows(), file_times.size()));
  }
  for (Eigen::Index i = 0; i < series.times.size(); ++i) {
    const bool ascends = i == 0 || series.times[i] > series.times[i - 1];
    if (!std::isfinite(series.times[i]) || !ascends || !series.values.col(i).allFinite()) {
      config.Fail("file", fmt::format("{}: row {} is not finite or does not follow the one before "
                                      "in time",
                                      file.string(), i + 1));
    }
  }
  return series;
}

// `time` lies the part t of the way from one of the times to another.
struct Between {
  Eigen::Index left, right;  // the same before the first time and after the last
  double t;
};

Between Bracket(const Eigen::VectorXd& times, double time) {
  const Eigen::Index last = times.size() - 1;
  const double* after = std::upper_bound(times.data(), times.data() + times.size(), time);
  const Eigen::Index right = after - times.data();
  if (right == 0) return {0, 0, 0};
  if (right > last) return {last, last, 0};
  return {right - 1, right, (time - times[right - 1]) / (times[right] - times[right - 1])};
}

Eigen::Vector3d Linear(const Eigen::VectorXd& times, const Eigen::Matrix3Xd& values, double time) {
  const auto [left, right, t] = Bracket(times, time);
  return (1 - t) * values.col(left) + t * values.col(right);
}

// A cubic between neighbouring times, with the velocity at each that a parabola through it and its
// neighbours has.
Eigen::Vector3d Smooth(const Eigen::VectorXd& times, const Eigen::Matrix3Xd& values, double time) {
  const auto [left, right, t] = Bracket(times, time);
  if (left == right) return values.col(left);
  const Eigen::Index last = times.size() - 1;
  const auto slope = [&](Eigen::Index k) -> Eigen::Vector3d {  // between k and k + 1
    return (values.col(k + 1) - values.col(k)) / (times[k + 1] - times[k]);
  };
  const auto knot = [&](Eigen::Index k) -> Knot<Eigen::Vector3d> {
    if (k == 0) return {values.col(0), slope(0)};
    if (k == last) return {values.col(last), slope(last - 1)};
    const double before = times[k] - times[k - 1], behind = times[k + 1] - times[k];
    return {values.col(k), (behind * slope(k - 1) + before * slope(k)) / (before + behind)};
  };
  return Interpolate(knot(left), knot(right), times[right] - times[left], t).position;
}

}  // namespace

Eigen::Vector3d ForceAt(const MeasuredForce& force, double time) {
  return Linear(force.times, force.forces, time);
}

Eigen::Isometry3d MotionAt(const RecordedGrip& grip, double time) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.translate(Smooth(grip.times, grip.displacements, time));
  if (grip.turns.cols() == 0) return motion;
  motion.translate(grip.pivot);
  motion.rotate(RotationBy(Smooth(grip.times, grip.turns, time)) *
                RotationBy(grip.turns.col(0)).transpose());
  motion.translate(-grip.pivot);
  return motion;
}

std::vector<RecordedGrip> ReadGrips(const Config& config, const Recording& recording,
                                    const std::vector<double>& file_times) {
  std::vector<RecordedGrip> grips;
  for (const Config& item : config.Items("gripped")) {
    RecordedGrip grip;
    grip.region = ReadRegion(item, recording.data_folder, fmt::format("grip {}", grips.size() + 1));
    grip.markers = item.Texts("follows_markers");
    const std::optional<Config> path = item.OptionalChild("path");
    if (!grip.markers.empty()) {
      if (path) item.Fail("path", "the grip already follows markers");
      if (recording.kind != FrameKind::kMarkers) {
        item.Fail("follows_markers", "the frames of this recording are not of kind markers");
      }
      SelectMarkers(recording.markers, grip.markers, recording.marker_file);
      grip.motion = GripMotion::kFollowsMarkers;
    } else if (path) {
      grip.motion = GripMotion::kGiven;
      const double unit = ReadUnit(*path, "length_unit", kLength, recording.length_unit);
      const TimeSeries series = ReadSeries(*path, recording, file_times, unit);
      grip.file = series.table.file;
      grip.times = series.times;
      grip.displacements = series.values.colwise() - Eigen::Vector3d(series.values.col(0));
      if (const std::optional<Config> turn = path->OptionalChild("turn")) {
        const double radian = ReadUnit(*turn, "unit", kAngle, "rad");
        grip.turns = VectorColumns(series.table,
                                   {turn->Text("x"), turn->Text("y"), turn->Text("z")}, radian);
        if (!grip.turns.allFinite())
          turn->Fail("x", grip.file.string() + ": a row of the turn is not finite");
        grip.pivot = turn->Vector("about", kLength);
      }
    } else {
      item.Choice<int>("follows", {{"scan", 0}}, "scan");
    }
    grip.deforms = item.Flag("deforms", false);
    if (grip.deforms && path) item.Fail("deforms", "the path tells a rigid motion");
    grips.push_back(std::move(grip));
  }
  return grips;
}

std::vector<MeasuredForce> ReadForces(const Config& config, const Recording& recording,
                                      const std::vector<double>& file_times) {
  std::vector<MeasuredForce> forces;
  for (const Config& item : config.Items("forces")) {
    MeasuredForce force;
    force.name = item.Text("name", fmt::format("force {}", forces.size() + 1));
    if (const auto region = item.OptionalChild("region")) {
      force.region = ReadRegion(*region, recording.data_folder, force.name);
    }
    if (item.Has("constant")) {
      if (item.Has("file")) item.Fail("file", "the force is already given as a constant");
      force.forces = item.Vector("constant", kForce);
      force.times = Eigen::VectorXd::Constant(1, recording.times.front());
    } else {
      const double unit = ReadUnit(item, "unit", kForce, "N");
      const TimeSeries series = ReadSeries(item, recording, file_times, unit);
      force.file = series.table.file;
      force.times = series.times;
      force.forces = series.values;
    }
    forces.push_back(std::move(force));
  }
  return forces;
}

}  // namespace lacuna
