#include "experiment/grip_tracks.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <string>
#include <utility>

#include "core/error.h"
#include "experiment/held_parts.h"
#include "geometry/rigid_fit.h"
#include "geometry/smooth_path.h"

namespace lacuna {

std::vector<int> MarkersOf(const RecordedGrip& grip, const Recording& recording) {
  const auto& names = recording.markers.names;
  std::vector<int> markers;
  for (const std::string& name : grip.markers)
    markers.push_back(
        static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin()));
  return markers;
}

Eigen::Matrix3Xd GripTracks::Track::At(double time) const {
  if (grip.motion == GripMotion::kGiven) return MotionAt(grip, time, times.front()) * rest;
  return SmoothPath(times, [this](size_t k) -> const Eigen::Matrix3Xd& { return places[k]; })
      .At(time);
}

void GripTracks::Track::RestAt(double time) {
  times = {time};
  places = {rest};
}

void GripTracks::Track::Add(double time, Eigen::Matrix3Xd place) {
  CHECK_GE(time, times.back());
  if (time == times.back()) {
    places.back() = std::move(place);
    return;
  }
  times.push_back(time);
  places.push_back(std::move(place));
}

GripTracks::GripTracks(const Recording& recording, const TetMesh& reference, Model* model)
    : recording_(recording), model_(*model) {
  std::vector<HeldPart> parts;
  for (const RecordedSupport& support : recording.object.fixed)
    parts.push_back({support.region, support.axes, /*moves=*/false});
  for (const RecordedGrip& grip : recording.object.grips)
    parts.push_back({grip.region, grip.axes, /*moves=*/true});
  const std::vector<Eigen::VectorXi> held =
      NamingWhere(recording.file.string(), [&] { return NodesOfParts(parts, reference); });
  auto nodes = held.begin();
  for (const RecordedSupport& support : recording.object.fixed)
    model->grips.push_back({*nodes++, {}, support.axes});
  for (const RecordedGrip& grip : recording.object.grips) {
    auto track = std::make_shared<Track>();
    track->grip = grip;
    track->nodes = *nodes++;
    track->rest = reference.nodes(Eigen::all, track->nodes);
    track->markers = MarkersOf(grip, recording);
    if (!track->markers.empty()) {
      const Eigen::Matrix3Xd places = recording.markers.places(Eigen::all, track->markers);
      track->span = FitRigidMotion(places, places).span;
      if (grip.deforms && track->span < 2)
        throw InputError(fmt::format(
            "{}: \"{}\" is to deform with its markers, which {}", recording.file.string(),
            grip.region.name,
            track->span < 0 ? "have no marker_places"
                            : "do not span a plane: three or more are needed, not on a line"));
    }
    const bool is_given = grip.motion == GripMotion::kGiven;
    track->RestAt(is_given ? grip.times[0] : recording.times.front());
    tracks_.push_back(track);
    model->grips.push_back(
        {track->nodes, [track](double time) { return track->At(time); }, grip.axes});
  }
}

void GripTracks::Begin(double time) {
  for (const auto& track : tracks_) track->RestAt(time);
}

const RecordedGrip* GripTracks::Extend(double time, const Eigen::Matrix3Xd& before,
                                       const Eigen::Matrix3Xd& moved,
                                       const Eigen::Matrix3Xd& markers) {
  const RecordedGrip* lost = nullptr;
  for (const auto& track : tracks_) {
    Eigen::Matrix3Xd place;
    switch (track->grip.motion) {
      case GripMotion::kGiven:
        continue;
      case GripMotion::kFollowsScan: {
        const Eigen::Matrix3Xd here = before(Eigen::all, track->nodes);
        const Eigen::Matrix3Xd there = moved(Eigen::all, track->nodes);
        const RigidFit fit = FitRigidMotion(here, there);
        place = track->grip.deforms ? FitAffineMotion(here, there, fit) * here : fit.motion * here;
        break;
      }
      case GripMotion::kFollowsMarkers: {
        const Eigen::Matrix3Xd at_rest = recording_.markers.places(Eigen::all, track->markers);
        const Eigen::Matrix3Xd seen = markers(Eigen::all, track->markers);
        const RigidFit fit = FitRigidMotion(at_rest, seen);
        if (fit.span < std::max(track->span, 0)) {
          lost = &track->grip;
          continue;
        }
        place = track->grip.deforms ? FitAffineMotion(at_rest, seen, fit) * track->rest
                                    : fit.motion * track->rest;
        break;
      }
    }
    track->Add(time, std::move(place));
  }
  return lost;
}

void GripTracks::Place(double time, Eigen::VectorXd* position) const {
  for (const Grip& grip : model_.grips) {
    const Eigen::Matrix3Xd places =
        grip.motion ? grip.motion(time)
                    : Eigen::Matrix3Xd(model_.body->mesh.nodes(Eigen::all, grip.nodes));
    for (Eigen::Index i = 0; i < grip.nodes.size(); ++i)
      for (int axis = 0; axis < 3; ++axis)
        if (grip.axes.Has(axis)) (*position)[3 * grip.nodes[i] + axis] = places(axis, i);
  }
}

}  // namespace lacuna
