#include "prediction/place_doubts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/first_few.h"
#include "geometry/rigid_fit.h"

namespace lacuna {
namespace {

// Markers closer to their places than this many deviations are where they should be. Smaller: a
// rough measurement of the places is taken for a mistake.
constexpr double kFarOff = 10;
// The share of the distance that remains where a mistake explains it. The rest is deformation, such
// as the sag of an object that was mirrored. Larger: a large deformation is taken for a mistake.
constexpr double kRemains = 0.25;
// The largest such share for a rotation, which the deflection of a slender body resembles, and the
// smallest angle of one.
constexpr double kRemainsOfTurn = 0.1, kLeastTurn = std::numbers::pi / 3;
// How often a unit of length is larger than one with which it is confused, and its rounding.
constexpr std::array kUnitRatios{10.0, 100.0, 1000.0, 25.4};
constexpr double kUnitRounding = 0.05;
constexpr Eigen::Index kFewestMarkers = 4;  // three are always in a plane
// Markers that span this share of the object's size would show that it is bent, not turned.
constexpr double kMostOfObject = 0.6;

double Rms(const Eigen::Matrix3Xd& vectors) {
  return std::sqrt(vectors.squaredNorm() / static_cast<double>(vectors.cols()));
}

double RmsAboutMean(const Eigen::Matrix3Xd& vectors) {
  return Rms(vectors.colwise() - Eigen::Vector3d(vectors.rowwise().mean()));
}

// For each of the measured markers, the one whose place is nearest.
std::vector<Eigen::Index> NearestPlaces(const Eigen::Matrix3Xd& places,
                                        const Eigen::Matrix3Xd& measured) {
  std::vector<Eigen::Index> nearest(static_cast<size_t>(measured.cols()));
  for (size_t m = 0; m < nearest.size(); ++m)
    (places.colwise() - measured.col(static_cast<Eigen::Index>(m)))
        .colwise()
        .squaredNorm()
        .minCoeff(&nearest[m]);
  return nearest;
}

// The markers that are at the places of others if each place has exactly one marker near; nothing
// otherwise.
std::vector<Eigen::Index> ExchangedMarkers(const Eigen::Matrix3Xd& places,
                                           const Eigen::Matrix3Xd& measured,
                                           const std::vector<Eigen::Index>& nearest, double far) {
  std::vector<Eigen::Index> sorted = nearest, exchanged;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return {};
  for (size_t m = 0; m < nearest.size(); ++m)
    if (nearest[m] != static_cast<Eigen::Index>(m))
      exchanged.push_back(static_cast<Eigen::Index>(m));
  if (exchanged.empty()) return {};
  const Eigen::Matrix3Xd own = measured - places, near = measured - places(Eigen::all, nearest);
  const double before = Rms(own(Eigen::all, exchanged)), after = Rms(near(Eigen::all, exchanged));
  if (before <= far || after > kRemains * before) return {};
  return exchanged;
}

std::string DescribeExchange(const std::vector<Eigen::Index>& exchanged,
                             const std::vector<Eigen::Index>& nearest,
                             const std::vector<std::string>& names) {
  std::vector<std::string> parts;
  for (const Eigen::Index index : exchanged) {
    const auto m = static_cast<size_t>(index);
    parts.push_back(fmt::format("{} is near the place of {}", names[m],
                                names[static_cast<size_t>(nearest[m])]));
  }
  return FirstFew(parts) + ": names or places of markers are exchanged";
}

// The ratio of units by which the tracks would have to be multiplied; 1 where none fits.
double UnitRatio(double ratio) {
  for (const double unit : kUnitRatios)
    for (const double factor : {unit, 1 / unit})
      if (std::abs(ratio / factor - 1) < kUnitRounding) return factor;
  return 1;
}

// "x, −z, y": the axes of the tracks that are the x, y and z of the places; empty where they are
// not parallel to one another. `linear` brings directions of the tracks to those of the places.
std::string NamesOfAxes(const Eigen::Matrix3d& linear) {
  constexpr double kParallel = 0.97;  // within 14°, for a deformed object
  std::vector<std::string> axes;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      if (std::abs(linear(row, column)) > kParallel)
        axes.push_back(fmt::format("{}{}", linear(row, column) < 0 ? "−" : "", "xyz"[column]));
  return axes.size() == 3 ? fmt::format("{}", fmt::join(axes, ", ")) : "";
}

// The orthogonal transform of the tracks that fits the places best.
struct OrthogonalFit {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  double remains = 0;  // m, rms distance
};
OrthogonalFit FitOrthogonal(const Eigen::Matrix3Xd& places, const Eigen::Matrix3Xd& measured,
                            bool mirrors) {
  const Eigen::Matrix3Xd from = (mirrors ? -1.0 : 1.0) * measured;
  const Eigen::Isometry3d motion = FitRigidMotion(from, places).motion;
  return {(mirrors ? -1.0 : 1.0) * motion.linear(), Rms((motion * from) - places)};
}

// Which change of the coordinate system would explain the distances; empty where none does.
std::string DescribeTransform(const Eigen::Matrix3Xd& places, const Eigen::Matrix3Xd& measured,
                              const ExpectedPlaces& expected) {
  const double spread = RmsAboutMean(places);
  const double ratio = UnitRatio(spread / RmsAboutMean(measured));
  const Eigen::Matrix3Xd scaled = ratio * measured;
  const OrthogonalFit turned = FitOrthogonal(places, scaled, false);
  const OrthogonalFit mirrored = FitOrthogonal(places, scaled, true);
  const double explained = kRemains * std::min(spread, RmsAboutMean(measured - places));
  if (ratio != 1 && std::min(turned.remains, mirrored.remains) <= explained)
    return fmt::format(
        "multiplied by {:.4g}, they would have the same distances from one another: `length_unit` "
        "is not the unit of the tracks, or the places have another unit",
        ratio);
  const auto axes = [](const Eigen::Matrix3d& linear) {
    const std::string names = NamesOfAxes(linear);
    return names.empty() ? "" : fmt::format(" (x, y, z of the places are {} of the tracks)", names);
  };
  if (mirrored.remains <= std::min(explained, kRemains * turned.remains))
    return fmt::format(
        "their arrangement is the mirror image of that of the places{}: one of the two coordinate "
        "systems is left-handed, or an axis has the wrong sign",
        axes(mirrored.linear));
  const double angle = Eigen::AngleAxisd(turned.linear).angle();
  if (expected.cannot_turn && angle > kLeastTurn &&
      turned.remains <= kRemainsOfTurn * Rms(measured - places))
    return fmt::format(
        "their arrangement is that of the places turned by {:.0f}°{}: `transform` under `frames` "
        "brings the tracks into the coordinate system of the places",
        angle * 180 / std::numbers::pi, axes(turned.linear));
  return "";
}

// Whether a held part is where it is on the undeformed object, as far as that is given.
bool IsAtRestPlace(const RecordedGrip& grip, double time, double tolerance) {
  if (grip.motion != GripMotion::kGiven) return false;
  const Eigen::Isometry3d motion = MotionAt(grip, time);
  constexpr double kStill = 0.05;  // rad
  return motion.translation().norm() <= tolerance &&
         Eigen::AngleAxisd(motion.linear()).angle() <= kStill;
}

// Whether the parts that are held in the first used frame hold the object along all axes, each at
// its undeformed place.
bool IsHeldAtRest(const PredictedRecording& item, double tolerance) {
  const RecordedObject& object = item.recording.object;
  AxisSet held;
  for (const RecordedSupport& support : object.fixed) held = held | support.axes;
  for (const RecordedGrip& grip : object.grips) {
    if (!IsAtRestPlace(grip, item.recording.times[item.frames.front()], tolerance)) return false;
    held = held | grip.axes;
  }
  return held.IsAll() && !item.hold;
}

}  // namespace

std::string DoubtOfPlaces(const Eigen::Matrix3Xd& places, const Eigen::Matrix3Xd& measured,
                          const std::vector<std::string>& names, const ExpectedPlaces& expected) {
  std::vector<Eigen::Index> seen;
  std::vector<std::string> names_seen;
  for (Eigen::Index m = 0; m < places.cols(); ++m) {
    if (!measured.col(m).allFinite() || !places.col(m).allFinite()) continue;
    seen.push_back(m);
    names_seen.push_back(names[static_cast<size_t>(m)]);
  }
  if (seen.size() < 2) return "";
  const Eigen::Matrix3Xd known = places(Eigen::all, seen), here = measured(Eigen::all, seen);
  const Eigen::RowVectorXd distance = (here - known).colwise().norm();
  const double far = kFarOff * expected.deviation;
  Eigen::Index farthest = 0;
  if (!(distance.maxCoeff(&farthest) > far)) return "";
  const std::vector<Eigen::Index> nearest = NearestPlaces(known, here);
  const std::vector<Eigen::Index> exchanged = ExchangedMarkers(known, here, nearest, far);
  const bool many_exchanged = 2 * exchanged.size() > seen.size();
  std::string cause;
  if (!exchanged.empty() && !many_exchanged)
    cause = DescribeExchange(exchanged, nearest, names_seen);
  if (cause.empty() && here.cols() >= kFewestMarkers && Rms(here - known) > far)
    cause = DescribeTransform(known, here, expected);
  if (cause.empty() && many_exchanged && expected.cannot_turn)
    cause = DescribeExchange(exchanged, nearest, names_seen);
  if (cause.empty()) return "";
  return fmt::format("markers are up to {:.3g} mm ({}) from their `marker_places`; {}",
                     1e3 * distance[farthest], names_seen[static_cast<size_t>(farthest)], cause);
}

std::string DoubtOfPlaces(const PredictionStudy& study, const PredictedRecording& item) {
  const Recording& recording = item.recording;
  const Markers& markers = recording.markers;
  if (item.ShowsScans() || HasTrackedPoints(recording) || markers.positions.empty() ||
      recording.reference.source == ReferenceSource::kFirstFrame)
    return "";
  const Eigen::Matrix3Xd& measured = markers.positions[static_cast<size_t>(item.frames.front())];
  const double radius = RmsAboutMean(markers.places);
  ExpectedPlaces expected;
  expected.deviation =
      std::hypot(study.place_deviation, item.shift_deviation, item.turn_deviation * radius);
  const double tolerance = kFarOff * expected.deviation;
  if (IsHeldAtRest(item, tolerance)) {
    const Eigen::AlignedBox3d spanned(markers.places.rowwise().minCoeff(),
                                      markers.places.rowwise().maxCoeff());
    expected.cannot_turn = spanned.diagonal().norm() >=
                           kMostOfObject * ReferenceBox(recording.reference).diagonal().norm();
  }
  const std::string doubt = DoubtOfPlaces(markers.places, measured, markers.names, expected);
  return doubt.empty() ? ""
                       : fmt::format("{}: in frame {}, {}", item.name, item.frames.front(), doubt);
}

}  // namespace lacuna
