#include "plan/planned_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.h"
#include "effects/attached_mass.h"
#include "effects/catalogue.h"
#include "effects/gravity.h"
#include "geometry/rotation.h"
#include "geometry/tri_mesh.h"
#include "plan/clamp_clearance.h"
#include "scan/marker_frames.h"
#include "scan/time_span.h"

namespace lacuna {
namespace {

// s before the first frame: when the fixture leaves its undeformed place, and when it has arrived.
constexpr double kLeaves = 2, kArrives = 1;
// Poses per frame of a path that is written anew; more: a smoother path, a larger file.
constexpr int kPosesPerFrame = 10;

// The parts that are held, as grips with a motion: a part that is fixed has a path on which it
// rests, so that it can be turned and shaken like any other.
std::vector<RecordedGrip> AsGrips(const RecordedObject& object, double first, double last) {
  std::vector<RecordedGrip> grips;
  for (const RecordedSupport& support : object.fixed) {
    RecordedGrip grip;
    grip.region = support.region;
    grip.axes = support.axes;
    grip.placement = support.placement;
    grip.motion = GripMotion::kGiven;
    grip.times = Eigen::Vector2d(first, last);
    grip.displacements = Eigen::Matrix3Xd::Zero(3, 2);
    grips.push_back(std::move(grip));
  }
  grips.insert(grips.end(), object.grips.begin(), object.grips.end());
  return grips;
}

// What the protocol does to the fixture: x → turn x + shake(t).
struct FixtureMotion {
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  std::optional<Protocol::Shake> shake;
  double start = 0;  // s, when the shaking begins

  Eigen::Isometry3d At(double time) const {
    Eigen::Isometry3d motion = turn;
    if (shake && time > start) {
      const double sine = std::sin(std::numbers::pi * shake->frequency * (time - start));
      motion.pretranslate(sine * sine * shake->amplitude);
    }
    return motion;
  }
};

// The rotation vector of `rotation` that is nearest to `previous`, so that a path of them has no
// jumps by whole turns.
Eigen::Vector3d RotationVectorNear(const Eigen::Matrix3d& rotation,
                                   const Eigen::Vector3d& previous) {
  const Eigen::AngleAxisd turn(rotation);
  const double whole = 2 * std::numbers::pi;
  const double turns = std::round((previous.dot(turn.axis()) - turn.angle()) / whole);
  return (turn.angle() + turns * whole) * turn.axis();
}

// The grip on the moved fixture. Its path begins at the undeformed place.
RecordedGrip OnFixture(const RecordedGrip& grip, const FixtureMotion& fixture,
                       const std::vector<double>& times) {
  RecordedGrip moved = grip;
  const double first = times.front();
  std::vector<double> at = {first - kLeaves, first - kArrives};
  const double spacing = (times.back() - first) / static_cast<double>(times.size() - 1);
  const int poses = kPosesPerFrame * static_cast<int>(times.size() - 1);
  for (int k = 0; k <= poses; ++k) at.push_back(first + spacing * k / kPosesPerFrame);
  at.back() = times.back();
  const Eigen::Index count = static_cast<Eigen::Index>(at.size());
  moved.times = Eigen::Map<const Eigen::VectorXd>(at.data(), count);
  moved.displacements = Eigen::Matrix3Xd::Zero(3, count);
  moved.rotations = Eigen::Matrix3Xd::Zero(3, count);
  for (Eigen::Index k = 1; k < count; ++k) {
    const double time = std::max(at[static_cast<size_t>(k)], first);
    const Eigen::Isometry3d pose = fixture.At(time) * MotionAt(grip, time);
    moved.rotations.col(k) = RotationVectorNear(pose.linear(), moved.rotations.col(k - 1));
    moved.displacements.col(k) = pose * grip.pivot - grip.pivot;
  }
  return moved;
}

// The fixture that the protocol turns about the middle of the first grip and shakes from `start`
// (s) on. Throws InputError where nothing holds the object, or a grip along some axes only.
FixtureMotion MovedFixture(const Protocol& protocol, const std::vector<RecordedGrip>& grips,
                           const TetMesh& mesh, double start) {
  const char* key = protocol.turn.isZero(0) ? "shake" : "turn";
  if (grips.empty()) throw InputError(fmt::format("{}: nothing holds the object", key));
  for (const RecordedGrip& grip : grips)
    if (!grip.axes.IsAll())
      throw InputError(
          fmt::format("{}: {} is held along {} only; a fixture with such a support can neither "
                      "be turned nor shaken",
                      key, grip.region.name, grip.axes.Names()));
  FixtureMotion fixture{Eigen::Isometry3d::Identity(), protocol.shake, start};
  const Eigen::Vector3d middle =
      mesh.nodes(Eigen::all, SelectNodes(grips.front().region, mesh)).rowwise().mean();
  fixture.turn.translate(middle);
  fixture.turn.rotate(RotationBy(protocol.turn));
  fixture.turn.translate(-middle);
  return fixture;
}

// Adds the last pose of a path once more, at `time` (s).
void RepeatLastPose(double time, RecordedGrip* grip) {
  const Eigen::Index count = grip->times.size();
  grip->times.conservativeResize(count + 1);
  grip->times[count] = time;
  grip->displacements.conservativeResize(Eigen::NoChange, count + 1);
  grip->displacements.col(count) = grip->displacements.col(count - 1);
  if (grip->rotations.cols() == 0) return;
  grip->rotations.conservativeResize(Eigen::NoChange, count + 1);
  grip->rotations.col(count) = grip->rotations.col(count - 1);
}

// Extends a given path that does not cover the frames at `times` (s) to the last of them: the grip
// rests in its last pose. The pose is given again one spacing after the last one, too: with a pose
// at the end alone, the spline through the poses would leave the last one with nearly the full
// velocity and swing back until the end.
void RestUntilLast(const std::vector<double>& times, RecordedGrip* grip) {
  const double end = times.back();
  if (grip->motion != GripMotion::kGiven || CoversTimes(grip->times, end, end, TimeMargin(times)))
    return;
  const Eigen::Index count = grip->times.size();
  if (count > 1) {
    const double stopped = 2 * grip->times[count - 1] - grip->times[count - 2];
    if (stopped < end) RepeatLastPose(stopped, grip);
  }
  RepeatLastPose(end, grip);
}

// Extends a force that was measured over time to `end` (s) with its last value.
void HoldUntil(double end, MeasuredForce* force) {
  const Eigen::Index count = force->times.size();
  if (count < 2 || force->times[count - 1] >= end) return;  // one value: a constant force
  force->times.conservativeResize(count + 1);
  force->times[count] = end;
  force->forces.conservativeResize(Eigen::NoChange, count + 1);
  force->forces.col(count) = force->forces.col(count - 1);
}

std::vector<double> PlannedTimes(const PredictedRecording& item, double factor) {
  std::vector<double> times;
  for (const int frame : item.frames) times.push_back(item.recording.times[frame]);
  if (factor == 1 || times.size() < 2) return times;
  const double start = item.StartTime(), last = times.back();
  const double end = start + factor * (last - start);
  const double spacing = (last - times.front()) / static_cast<double>(times.size() - 1);
  std::erase_if(times, [&](double time) { return time > end + 0.5 * spacing; });
  while (times.back() + 0.5 * spacing < end) times.push_back(times.back() + spacing);
  return times;
}

// The markers of a planned recording. Those that grips follow move with the fixture.
Markers PlannedMarkers(const PredictedRecording& item, const std::vector<double>& times,
                       const FixtureMotion& fixture) {
  Markers markers = item.recording.markers;
  markers.positions.clear();
  markers.weights.clear();  // recordings of markers have no σ of single points
  for (size_t k = 0; k < times.size(); ++k) {
    const int frame = item.frames[std::min(k, item.frames.size() - 1)];
    Eigen::Matrix3Xd positions = item.recording.markers.positions[frame];
    for (Eigen::Index m = 0; m < positions.cols(); ++m)
      if (!positions.col(m).allFinite()) positions.col(m) = markers.places.col(m);
    markers.positions.push_back(fixture.At(times[k]) * positions);
  }
  return markers;
}

// The first of new1, new2, … that is not among `names`: a recording with more markers may have been
// planned itself.
std::string UnusedMarkerName(const std::vector<std::string>& names) {
  std::string name;
  int number = 0;
  do {
    name = fmt::format("new{}", ++number);
  } while (std::find(names.begin(), names.end(), name) != names.end());
  return name;
}

// Adds markers at nodes of the surface that no grip holds, each as far as possible from all others.
void AddMarkers(int count, const TetMesh& mesh, const std::vector<RecordedGrip>& grips,
                Markers* markers) {
  const BoundarySurface boundary = ExtractBoundary(mesh);
  std::vector<char> held(static_cast<size_t>(mesh.NodeCount()), 0);
  for (const RecordedGrip& grip : grips)
    for (const int node : SelectNodes(grip.region, mesh)) held[static_cast<size_t>(node)] = 1;
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3d& place : markers->places.colwise()) points.push_back(place);
  const int before = static_cast<int>(points.size());
  for (const int node : boundary.node)
    if (!held[static_cast<size_t>(node)]) points.push_back(mesh.nodes.col(node));
  if (static_cast<int>(points.size()) < before + count)
    throw InputError(fmt::format("more_markers: the mesh has room for {} more only",
                                 static_cast<int>(points.size()) - before));
  // Squared distance of each point to the nearest marker, existing (these come first) or chosen; 0
  // for a marker itself.
  const auto distance = [&](int a, int b) { return (points[a] - points[b]).squaredNorm(); };
  std::vector<double> away(points.size(), std::numeric_limits<double>::infinity());
  const auto take = [&](int taken) {
    for (size_t k = 0; k < points.size(); ++k)
      away[k] = std::min(away[k], distance(static_cast<int>(k), taken));
  };
  for (int k = 0; k < before; ++k) take(k);
  markers->places.conservativeResize(Eigen::NoChange, before + count);
  for (int k = 0; k < count; ++k) {
    const int best = static_cast<int>(std::max_element(away.begin(), away.end()) - away.begin());
    take(best);
    markers->places.col(before + k) = points[static_cast<size_t>(best)];
    markers->names.push_back(UnusedMarkerName(markers->names));
  }
  for (Eigen::Matrix3Xd& positions : markers->positions) {
    positions.conservativeResize(Eigen::NoChange, before + count);
    positions.rightCols(count) = markers->places.rightCols(count);
  }
}

void Pull(double factor, PredictedRecording* item) {
  RecordedObject& object = item->recording.object;
  if (factor == 1 || item->hold) return;  // the force of a hold is not part of the recording
  if (!object.forces.empty()) {
    for (MeasuredForce& force : object.forces) force.forces *= factor;
    return;
  }
  bool pulls = false;
  for (RecordedGrip& grip : object.grips) {
    if (grip.motion != GripMotion::kGiven) continue;
    pulls = pulls || !grip.displacements.isZero(0);
    grip.displacements *= factor;
  }
  if (!pulls)
    throw InputError(
        "pull: nothing pulls: the recording has no hold, no known force and no grip "
        "that moves along a given path");
}

std::shared_ptr<const Effect> AttachedWeight(const Protocol::Weight& weight,
                                             const PredictionStudy& study, const TetMesh& mesh) {
  const Eigen::AlignedBox3d box = BoundingBox(mesh.nodes);
  if (box.exteriorDistance(weight.place) > weight.radius)
    throw InputError(fmt::format("weight: its place is {:.3g} mm away from the object",
                                 1e3 * box.exteriorDistance(weight.place)));
  for (const ModelParameter& parameter : study.fitted)
    if (IsGravity(EffectOf(parameter, study.effects)))
      throw InputError(
          fmt::format("weight: that of a mass in one recording does not follow {}, "
                      "which is fitted",
                      parameter.prior.name));
  const Eigen::Vector3d gravity = GravityOf(study.effects).value_or(Eigen::Vector3d::Zero());
  return MakeAttachedMass(weight.mass, weight.place, weight.radius, gravity);
}

const PredictedRecording& BaseOf(const Protocol& protocol, const PredictionStudy& study) {
  for (const PredictedRecording& item : study.recordings)
    if (item.name == protocol.recording) return item;
  throw InputError(fmt::format("the run has no recording \"{}\"", protocol.recording));
}

}  // namespace

PlannedRecording PlanRecording(const Protocol& protocol, const PredictionStudy& study,
                               const TetMesh& mesh) {
  const PredictedRecording& base = BaseOf(protocol, study);
  PlannedRecording planned;
  PredictedRecording& item = planned.item;
  item = base;
  item.name = item.recording.name = protocol.name;
  item.fitted = true;
  item.fit_until = std::numeric_limits<double>::infinity();
  item.simulated_cells.clear();  // a plan shows what is expected
  item.recording.frames = MarkerFrames();
  const std::vector<double> times = PlannedTimes(base, protocol.duration);
  const size_t fewest = study.scheme == TimeScheme::kQuasiStatic ? 1 : 3;
  if (times.size() < fewest)
    throw InputError(
        fmt::format("duration: leaves {} frames; at least {} are needed", times.size(), fewest));
  Pull(protocol.pull, &item);

  RecordedObject& object = item.recording.object;
  for (RecordedGrip& grip : object.grips) RestUntilLast(times, &grip);
  std::vector<RecordedGrip> grips = AsGrips(object, times.front() - kLeaves, times.back());
  FixtureMotion fixture;
  if (!protocol.turn.isZero(0) || protocol.shake) {
    fixture = MovedFixture(protocol, grips, mesh, base.StartTime());
    for (RecordedGrip& grip : grips)
      if (grip.motion == GripMotion::kGiven) grip = OnFixture(grip, fixture, times);
    object.fixed.clear();
    object.grips = grips;
  }
  planned.fixture = fixture.turn;
  for (MeasuredForce& force : object.forces) HoldUntil(times.back(), &force);
  for (MeasuredReaction& reaction : object.reactions) {
    reaction.times =
        Eigen::Map<const Eigen::VectorXd>(times.data(), static_cast<Eigen::Index>(times.size()));
    reaction.values = Eigen::MatrixXd::Zero(reaction.Components(), reaction.times.size());
  }
  const std::vector<double> recorded_times = PlannedTimes(base, 1);
  const std::vector<RecordedGrip> recorded_grips =
      AsGrips(base.recording.object, recorded_times.front() - kLeaves, recorded_times.back());
  RequireClampAbovePlanes({grips, times}, {recorded_grips, recorded_times}, study.effects, mesh);

  item.recording.markers = PlannedMarkers(base, times, fixture);
  if (protocol.more_markers > 0)
    AddMarkers(protocol.more_markers, mesh, grips, &item.recording.markers);
  if (protocol.weight) item.effects.push_back(AttachedWeight(*protocol.weight, study, mesh));
  item.recording.times = times;
  item.frames.resize(times.size());
  for (size_t k = 0; k < times.size(); ++k) item.frames[k] = static_cast<int>(k);
  return planned;
}

namespace {

// Curves of three components over time; none where nothing changes and all is 0.
void AddCurves(const std::string& what, const std::string& unit, const Eigen::Matrix3Xd& values,
               ProtocolPicture* picture) {
  if (values.isZero(0)) return;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Eigen::VectorXd row = values.row(axis);
    picture->curves.push_back({what, std::string(1, "xyz"[axis]), unit, {row.begin(), row.end()}});
  }
}

}  // namespace

ProtocolPicture PictureOf(const PlannedRecording& planned, const TetMesh& mesh,
                          const Eigen::Vector3d& hold) {
  constexpr Eigen::Index kPoints = 241;
  const PredictedRecording& item = planned.item;
  const RecordedObject& object = item.recording.object;
  const Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(kPoints, item.recording.times.front(),
                                                           item.recording.times.back());
  ProtocolPicture picture;
  picture.times.assign(times.begin(), times.end());
  if (item.hold) picture.release = item.hold->release;
  Eigen::Matrix3Xd path(3, kPoints), turn(3, kPoints), force(3, kPoints);
  for (const RecordedGrip& grip : object.grips) {
    if (grip.motion != GripMotion::kGiven) continue;
    const Eigen::Vector3d middle =
        mesh.nodes(Eigen::all, SelectNodes(grip.region, mesh)).rowwise().mean();
    turn.col(0).setZero();
    for (Eigen::Index k = 0; k < kPoints; ++k) {
      const Eigen::Isometry3d motion = MotionAt(grip, times[k]);
      path.col(k) = motion * middle - middle;
      turn.col(k) = RotationVectorNear(motion.linear(), turn.col(std::max<Eigen::Index>(k - 1, 0)));
    }
    AddCurves("path of " + grip.region.name, "m", path, &picture);
    AddCurves("rotation of " + grip.region.name, "rad", turn, &picture);
  }
  for (const MeasuredForce& known : object.forces) {
    for (Eigen::Index k = 0; k < kPoints; ++k) force.col(k) = ForceAt(known, times[k]);
    AddCurves(known.name, "N", force, &picture);
  }
  if (item.hold) {
    for (Eigen::Index k = 0; k < kPoints; ++k)
      force.col(k) = (times[k] < item.hold->release ? 1.0 : 0.0) * hold;
    AddCurves("force that holds", "N", force, &picture);
  }
  return picture;
}

Eigen::Vector3d PlannedHoldForce(const Protocol& protocol, const Eigen::Vector3d& before) {
  return protocol.pull * (RotationBy(protocol.turn) * before);
}

}  // namespace lacuna
