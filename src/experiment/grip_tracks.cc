#include "experiment/grip_tracks.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "core/error.h"
#include "experiment/model_reader.h"
#include "geometry/rigid_fit.h"

namespace lacuna {
namespace {

Eigen::Matrix3Xd Interpolated(const std::map<double, Eigen::Matrix3Xd>& places, double time) {
  const auto after = places.lower_bound(time);
  if (after == places.end()) return places.rbegin()->second;
  if (after == places.begin() || after->first == time) return after->second;
  const auto before = std::prev(after);
  const double share = (time - before->first) / (after->first - before->first);
  return (1 - share) * before->second + share * after->second;
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
  std::map<int, std::string> holder;  // for each held node, the name of its region
  const auto nodes_in = [&](const Region& region) {
    return NamingWhere(recording.file.string(), [&] {
      const Eigen::VectorXi nodes = NodesIn(region, reference.nodes);
      for (const int node : nodes) {
        const auto [held, is_new] = holder.emplace(node, region.name);
        if (!is_new)
          throw InputError(fmt::format("regions \"{}\" and \"{}\" hold the same part of the object",
                                       held->second, region.name));
      }
      if (holder.size() == static_cast<size_t>(reference.nodes.cols()))
        throw InputError(fmt::format(
            "region \"{}\" holds the whole object: no part is free to move", region.name));
      return nodes;
    });
  };
  for (const Region& region : recording.object.fixed)
    model->grips.push_back({nodes_in(region), {}});
  for (const RecordedGrip& grip : recording.object.grips) {
    auto track = std::make_shared<Track>();
    track->grip = grip;
    track->nodes = nodes_in(grip.region);
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
    tracks_.push_back(track);
    model->grips.push_back({track->nodes, [track](double time) -> Eigen::Matrix3Xd {
                              if (track->grip.motion == GripMotion::kGiven)
                                return MotionAt(track->grip, time) * track->rest;
                              return Interpolated(track->places, time);
                            }});
  }
  Begin(recording.times.front());
}

void GripTracks::Begin(double time) {
  for (const auto& track : tracks_) track->places = {{time, track->rest}};
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
      position->segment<3>(3 * grip.nodes[i]) = places.col(i);
  }
}

}  // namespace lacuna
