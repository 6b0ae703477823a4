#include "prediction/recording_model.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "experiment/grip_tracks.h"
#include "experiment/known_loads.h"
#include "experiment/scan_grips.h"
#include "experiment/surface_observer.h"

namespace lacuna {
namespace {

// The smallest share of the patches that a scan must show. Larger: small visible parts are refused;
// smaller: a scan in another unit of length, inside the object, is taken for one of it.
constexpr double kFewestSeen = 0.05;
// A scan whose points are on average farther from the undeformed surface than this share of the
// object's size shows something else: a straight rod that bends from one end into any other
// direction moves its points by half of its length on average.
constexpr double kElsewhere = 0.75;

double ShareUsed(const Observed& observed) {
  return observed.offered > 0 ? static_cast<double>(observed.used) / observed.offered : 0;
}

// For each frame, the positions (3 × nodes) of all nodes, with those of grips that follow the scan
// moved by their grip.
std::vector<Eigen::Matrix3Xd> FollowGrips(const PredictedRecording& item, double reach,
                                          bool defines_body_shape, const TetMesh& mesh,
                                          const BoundarySurface& boundary) {
  const bool rests_at_first =
      defines_body_shape && item.recording.reference.source == ReferenceSource::kFirstFrame;
  std::vector<Eigen::Matrix3Xd> moved(item.frames.size(), mesh.nodes);
  for (const RecordedGrip& grip : item.recording.object.grips) {
    if (grip.motion != GripMotion::kFollowsScan) continue;
    const std::vector<int> nodes =
        NamingWhere(item.recording.file.string(), [&] { return SelectNodes(grip.region, mesh); });
    const std::vector<Eigen::Isometry3d> motions = FollowGrip(
        *item.scans, item.frames, boundary, {grip.region.name, nodes, reach, rests_at_first});
    for (size_t k = 0; k < motions.size(); ++k)
      for (const int node : nodes) moved[k].col(node) = motions[k] * mesh.nodes.col(node);
  }
  return moved;
}

void MoveGrips(const PredictedRecording& item, double reach, bool defines_body_shape,
               const TetMesh& mesh, const BoundarySurface& boundary, GripTracks* grips) {
  const bool is_scan = item.ShowsScans();
  std::vector<Eigen::Matrix3Xd> moved;
  if (is_scan) moved = FollowGrips(item, reach, defines_body_shape, mesh, boundary);
  for (size_t k = 0; k < item.frames.size(); ++k) {
    const int frame = item.frames[k];
    const RecordedGrip* lost =
        grips->Extend(item.recording.times[frame], mesh.nodes, is_scan ? moved[k] : mesh.nodes,
                      is_scan ? Eigen::Matrix3Xd(3, 0) : item.recording.markers.positions[frame]);
    // A grip's motion is interpolated across frames that do not show it, but cannot be extrapolated
    // before the first frame or after the last.
    if (lost != nullptr && (k == 0 || k + 1 == item.frames.size()))
      throw InputError(fmt::format(
          "{}: frame {}, the {} that is used, shows too few of the markers that \"{}\" follows: "
          "change `{}`",
          item.recording.file.string(), frame, k == 0 ? "first" : "last", lost->region.name,
          k == 0 ? "from" : "to"));
  }
}

// A scanned object that is not held must rest in its first frames.
void RequireStartAtRest(const PredictedRecording& item) {
  if (item.hold) return;
  const ScannedPoints& first = item.scans->At(item.frames.front());
  const double step = LargestMove(first, item.scans->At(item.frames[1]));
  const double whole = LargestMove(first, item.scans->At(item.frames.back()));
  constexpr double kNoise = 4;  // standard deviations of one point
  if (step > 0.25 * whole && step > kNoise * first.noise) {
    throw InputError(fmt::format(
        "{}: the object already moves between its first two frames, by {:.2f} mm; a prediction "
        "starts from rest: give `from:` or `hold:`",
        item.recording.file.string(), 1e3 * step));
  }
}

// Throws InputError where a marker's place is farther from the object than half of the object's
// size.
void RequireMarkersNear(const Recording& recording, const TetMesh& mesh) {
  constexpr double kFar = 0.5;
  const Eigen::AlignedBox3d box = BoundingBox(mesh.nodes);
  const double size = box.diagonal().norm();
  for (Eigen::Index m = 0; m < recording.markers.places.cols(); ++m) {
    const double away = box.exteriorDistance(Eigen::Vector3d(recording.markers.places.col(m)));
    if (away > kFar * size)
      throw InputError(fmt::format(
          "{}: marker_places: {} sits {:.3g} mm away from the object, which measures {:.3g} mm",
          recording.file.string(), recording.markers.names[static_cast<size_t>(m)], 1e3 * away,
          1e3 * size));
  }
}

}  // namespace

RecordingModel::RecordingModel(const PredictionStudy& study, const PredictedRecording& recording,
                               const TetMesh& mesh, std::shared_ptr<const Body> body,
                               const SurfacePatches& patches)
    : study_(study), recording_(recording) {
  model_.body = std::move(body);
  model_.effects = study.effects;
  model_.effects.insert(model_.effects.end(), recording.effects.begin(), recording.effects.end());
  GripTracks grips(recording.recording, mesh, &model_);
  const bool defines_body_shape = &recording == &study.recordings.front();
  if (recording_.ShowsScans()) {
    auto observer =
        std::make_unique<SurfaceObserver>(recording_.scans, model_.body, patches, study.scan);
    if (study.scheme != TimeScheme::kQuasiStatic) RequireStartAtRest(recording_);
    const double reach = observer->Reach();
    observer_ = std::move(observer);
    RequireThatScansShowTheObject();
    MoveGrips(recording_, reach, defines_body_shape, mesh, model_.body->boundary, &grips);
  } else {
    // The elements of the body are in another order than those of `mesh`.
    RequireMarkersNear(recording_.recording, mesh);
    observer_ = std::make_unique<MarkerObserver>(recording_.recording, model_.body->mesh);
    MoveGrips(recording_, 0, defines_body_shape, mesh, model_.body->boundary, &grips);
  }
  for (const auto& load : MakeKnownForces(recording.recording, model_))
    model_.effects.push_back(load);
  AddNuisances(mesh);
}

void RecordingModel::RequireThatScansShowTheObject() {
  // Reads all frames, so that one that cannot be read is reported before the long computation.
  for (const int frame : recording_.frames) recording_.scans->At(frame);
  const Observed first =
      observer_->Observe(recording_.frames.front(), model_.body->mesh.nodes.reshaped());
  shown_ = ShareUsed(first);
  const bool may_be_deformed = study_.scheme == TimeScheme::kQuasiStatic && shown_ < 0.5;
  if (!Shows(first) || may_be_deformed) shown_ = 1;
  const double size = BoundingBoxDiagonal(model_.body->mesh.nodes);
  if (Shows(first) || first.distance < kElsewhere * size) return;
  throw InputError(fmt::format(
      "{}: frame {} shows {} of {} patches of the undeformed surface: its points lie elsewhere, "
      "farther than any deformation could move the object, or their length unit or transform is "
      "wrong",
      recording_.recording.file.string(), recording_.frames.front(),
      (first.count.array() > 0).count(), PointCount()));
}

bool RecordingModel::Shows(const Observed& observed) const {
  return (observed.count.array() > 0).count() >= kFewestSeen * PointCount();
}

RecordingModel RecordingModel::With(const EffectList& effects) const {
  RecordingModel with = *this;
  CHECK_EQ(effects.size(), study_.effects.size());
  std::copy(effects.begin(), effects.end(), with.model_.effects.begin());
  return with;
}

std::vector<int> RecordingModel::LostFrames(const Misfit& misfit, double least) const {
  std::vector<int> lost;
  if (!recording_.ShowsScans()) return lost;
  double best = shown_;
  for (const Observed& observed : misfit.observed) best = std::max(best, ShareUsed(observed));
  for (size_t f = 0; f < misfit.observed.size(); ++f)
    if (ShareUsed(misfit.observed[f]) < least * best) lost.push_back(misfit.frames[f]);
  return lost;
}

}  // namespace lacuna
