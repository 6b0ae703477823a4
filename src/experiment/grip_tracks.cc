#include "experiment/grip_tracks.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "core/error.h"
#include "experiment/held_parts.h"
#include "geometry/hermite.h"
#include "geometry/rigid_fit.h"

namespace lacuna {
namespace {

using Places = std::map<double, Eigen::Matrix3Xd>;

// The places at a time, with the velocity of the parabola through them and those before and behind.
Knot<Eigen::Matrix3Xd> KnotOf(const Places& places, Places::const_iterator at) {
  const auto velocity = [](Places::const_iterator from, Places::const_iterator to) {
    return Eigen::Matrix3Xd((to->second - from->second) / (to->first - from->first));
  };
  const auto behind = std::next(at);
  if (at == places.begin()) return {at->second, velocity(at, behind)};
  const auto before = std::prev(at);
  if (behind == places.end()) return {at->second, velocity(before, at)};
  return {at->second, VelocityOfParabola(velocity(before, at), at->first - before->first,
                                         velocity(at, behind), behind->first - at->first)};
}

// Along a smooth curve, as the path of a grip is (scan/time_series.h), and straight on behind the
// last frame: a jump of the velocity would be a shock.
Eigen::Matrix3Xd Interpolated(const Places& places, double time) {
  const auto after = places.lower_bound(time);
  if (after == places.end()) {
    // The last time step ends behind the last frame, in which the grip need not have stopped.
    const auto last = std::prev(places.end());
    if (places.size() == 1) return last->second;
    return last->second + (time - last->first) * KnotOf(places, last).velocity;
  }
  if (after == places.begin() || after->first == time) return after->second;
  const auto before = std::prev(after);
  const double length = after->first - before->first;
  return Interpolate(KnotOf(places, before), KnotOf(places, after), length,
                     (time - before->first) / length)
      .position;
}

}  // namespace

std::vector<int> MarkersOf(const RecordedGrip& grip, const Recording& recording) {
  const auto& names = recording.markers.names;
  std::vector<int> markers;
  for (const std::string& name : grip.markers)
    markers.push_back(
        static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin()));
  return markers;
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
    if (grip.motion == GripMotion::kGiven)
      track->since = grip.times[0];
    else
      track->places = {{recording.times.front(), track->rest}};
    tracks_.push_back(track);
    model->grips.push_back({track->nodes,
                            [track](double time) -> Eigen::Matrix3Xd {
                              if (track->grip.motion == GripMotion::kGiven)
                                return ContinuedMotionAt(track->grip, time, track->since) *
                                       track->rest;
                              return Interpolated(track->places, time);
                            },
                            grip.axes});
  }
}

void GripTracks::Begin(double time) {
  for (const auto& track : tracks_) {
    if (track->grip.motion == GripMotion::kGiven)
      track->since = time;
    else
      track->places = {{time, track->rest}};
  }
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
    track->places[time] = place;
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
