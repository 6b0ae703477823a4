#include "plan/protocol.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "effects/gravity.h"
#include "effects/uniform_density.h"
#include "geometry/tet_mesh.h"
#include "report/quantity_text.h"

namespace lacuna {
namespace {

// The stock variants shake by this share of the object's size and add this share of its mass, which
// is large enough to be seen and small enough to leave the experiment what it is.
constexpr double kShakeShare = 0.03, kWeightShare = 0.1, kWeightRadius = 0.03;
// Periods of a stock variant's shaking in one recording; fewer where its frames or the time step
// cannot resolve as many.
constexpr double kShakePeriods = 4;

bool HoldsSomething(const RecordedObject& object) {
  return !object.fixed.empty() || !object.grips.empty();
}

bool IsPulled(const PredictedRecording& item) {
  const RecordedObject& object = item.recording.object;
  return item.hold || !object.forces.empty() ||
         std::any_of(object.grips.begin(), object.grips.end(), [](const RecordedGrip& grip) {
           return grip.motion == GripMotion::kGiven && !grip.displacements.isZero(0);
         });
}

// The place of the marker that is farthest from the first held part: where a weight acts most.
Eigen::Vector3d FarthestMarker(const PredictedRecording& item, const TetMesh& mesh) {
  const RecordedObject& object = item.recording.object;
  Eigen::Vector3d from = mesh.nodes.rowwise().mean();
  if (HoldsSomething(object)) {
    const Region& held =
        object.fixed.empty() ? object.grips.front().region : object.fixed.front().region;
    from = mesh.nodes(Eigen::all, SelectNodes(held, mesh)).rowwise().mean();
  }
  const Eigen::Matrix3Xd& places = item.recording.markers.places;
  Eigen::Index farthest = 0;
  (places.colwise() - from).colwise().norm().maxCoeff(&farthest);
  return places.col(farthest);
}

std::string AxisText(const Eigen::Vector3d& axis) {
  for (int k = 0; k < 3; ++k)
    if (axis.isApprox(Eigen::Vector3d::Unit(k), 1e-9)) return std::string(1, "xyz"[k]);
  return fmt::format("({:.3g}, {:.3g}, {:.3g})", axis.x(), axis.y(), axis.z());
}

}  // namespace

std::string DescribeProtocol(const Protocol& protocol) {
  std::vector<std::string> changes;
  if (protocol.pull != 1) changes.push_back(fmt::format("{:g} times the pull", protocol.pull));
  const double angle = protocol.turn.norm();
  if (angle > 0)
    changes.push_back(fmt::format("clamp turned by {:.3g}° about {}",
                                  angle * 180 / std::numbers::pi, AxisText(protocol.turn / angle)));
  if (protocol.shake)
    changes.push_back(fmt::format(
        "clamp shaken by {} along {} at {:.3g} Hz", Millimetres(protocol.shake->amplitude.norm()),
        AxisText(protocol.shake->amplitude.normalized()), protocol.shake->frequency));
  if (protocol.weight)
    changes.push_back(fmt::format("{:.3g} g fixed at ({:.1f}, {:.1f}, {:.1f}) mm",
                                  1e3 * protocol.weight->mass, 1e3 * protocol.weight->place.x(),
                                  1e3 * protocol.weight->place.y(),
                                  1e3 * protocol.weight->place.z()));
  if (protocol.more_markers > 0)
    changes.push_back(fmt::format("{} more markers", protocol.more_markers));
  if (protocol.duration != 1)
    changes.push_back(fmt::format("recorded for {:g} times as long", protocol.duration));
  if (changes.empty()) return fmt::format("\"{}\" once more", protocol.recording);
  return fmt::format("\"{}\" with {}", protocol.recording, fmt::join(changes, ", "));
}

double HighestShakeFrequency(const PredictedRecording& item, double time_step) {
  const std::vector<double>& times = item.recording.times;
  double highest = 1 / (kStepsPerPeriod * time_step);
  if (item.frames.size() > 1) {
    const double intervals = static_cast<double>(item.frames.size() - 1);
    const double duration = times[item.frames.back()] - times[item.frames.front()];
    highest = std::min(highest, intervals / (kFramesPerPeriod * duration));
  }
  return highest;
}

const PredictedRecording& PlannableRecording(const PredictionStudy& study) {
  for (const PredictedRecording& item : study.recordings)
    if (item.fitted && !item.ShowsScans()) return item;
  throw InputError({study.file.string()},
                   "no fitted recording has markers or tracked points; recordings of scans cannot "
                   "be planned yet");
}

std::vector<Protocol> StockProtocols(const PredictionStudy& study, const TetMesh& mesh) {
  const PredictedRecording& item = PlannableRecording(study);
  const RecordedObject& object = item.recording.object;
  const std::vector<double>& times = item.recording.times;
  const bool moves = study.scheme != TimeScheme::kQuasiStatic;
  std::vector<Protocol> stock;
  const auto add = [&](const std::string& name) -> Protocol& {
    Protocol& protocol = stock.emplace_back();
    protocol.name = name;
    protocol.recording = item.name;
    return protocol;
  };
  add("repeat");
  if (moves) add("longer").duration = 2;
  if (IsPulled(item)) {
    add("pull twice").pull = 2;
    add("pull half").pull = 0.5;
    if (moves) {
      Protocol& both = add("pull twice, longer");
      both.pull = 2;
      both.duration = 2;
    }
  }
  if (HoldsSomething(object)) {
    const std::optional<Eigen::Vector3d> gravity = GravityOf(study.effects);
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d about = Eigen::Vector3d::Unit(axis);
      // A turn about the vertical changes nothing.
      if (gravity && about.cross(*gravity).norm() < 0.1 * gravity->norm()) continue;
      add(fmt::format("turn about {}", "xyz"[axis])).turn = 0.5 * std::numbers::pi * about;
    }
    const double duration = times[item.frames.back()] - item.StartTime();
    const double size = BoundingBoxDiagonal(mesh.nodes);
    const double frequency =
        std::min(kShakePeriods / duration, HighestShakeFrequency(item, study.time_step));
    for (int axis = 0; moves && duration > 0 && axis < 3; ++axis)
      add(fmt::format("shake along {}", "xyz"[axis])).shake =
          Protocol::Shake{kShakeShare * size * Eigen::Vector3d::Unit(axis), frequency};
  }
  const double mass = DensityWith(study.effects, study.density) *
                      (TetVolumes(mesh).sum() + VolumeOfCurvature(mesh));
  add("added mass").weight = Protocol::Weight{kWeightShare * mass, FarthestMarker(item, mesh),
                                              kWeightRadius * BoundingBoxDiagonal(mesh.nodes)};
  add("more markers").more_markers = static_cast<int>(item.recording.markers.names.size());
  return stock;
}

}  // namespace lacuna
