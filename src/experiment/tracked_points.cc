#include "experiment/tracked_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>
#include <utility>
#include <variant>

#include "core/error.h"
#include "experiment/frame_states.h"
#include "geometry/farthest_first.h"

namespace lacuna {
namespace {

// So many points suffice for a smooth motion. Image correlation gives thousands, whose derivatives
// with respect to every hypothesis would not fit into memory.
constexpr size_t kMostPoints = 400, kMostOfGrip = 40;

// At most `most` of the points, each as far as possible from those before it.
std::vector<int> EvenlySpread(const Eigen::Matrix3Xd& points, const std::vector<int>& from,
                              size_t most) {
  if (from.size() <= most) return from;
  const auto distance = [&](int a, int b) {
    return (points.col(from[a]) - points.col(from[b])).squaredNorm();
  };
  std::vector<int> chosen;
  for (const int k :
       FarthestFirst(static_cast<int>(from.size()), 0, static_cast<int>(most), distance))
    chosen.push_back(from[k]);
  return chosen;
}

}  // namespace

void ConvertTrackedPointsToMarkers(const std::vector<int>& frames, Recording* recording) {
  const Eigen::Matrix3Xd places = PointsByRow(LoadFrame(*recording, frames.front()));
  std::vector<int> seen;
  for (int row = 0; row < places.cols(); ++row)
    if (places.col(row).allFinite()) seen.push_back(row);
  if (seen.empty())
    throw InputError(
        fmt::format("{}: frame {}, the first that is used, shows no point: change `from`",
                    recording->file.string(), frames.front()));
  const std::vector<int> spread = EvenlySpread(places, seen, kMostPoints);
  std::set<int> chosen(spread.begin(), spread.end());
  for (RecordedGrip& grip : recording->object.grips) {
    if (grip.motion != GripMotion::kFollowsScan) continue;
    if (std::holds_alternative<NodeRegion>(grip.region.shape))
      throw InputError(
          fmt::format("{}: \"{}\" lists nodes, which do not determine the tracked points "
                      "that it follows: describe it by a shape, or give a `path`",
                      recording->file.string(), grip.region.name));
    const std::vector<int> inside = NamingWhere(recording->file.string(), [&] {
      const Eigen::Matrix3Xd shown = places(Eigen::all, seen);
      std::vector<int> rows;
      for (const int k : SelectNodes(grip.region, shown)) rows.push_back(seen[k]);
      return rows;
    });
    grip.motion = GripMotion::kFollowsMarkers;
    for (const int row : EvenlySpread(places, inside, kMostOfGrip)) {
      chosen.insert(row);
      grip.markers.push_back(fmt::format("p{}", row));
    }
  }
  const std::vector<int> rows(chosen.begin(), chosen.end());
  recording->markers.places = places(Eigen::all, rows);
  for (const int row : rows) recording->markers.names.push_back(fmt::format("p{}", row));
  recording->markers.positions.assign(
      recording->times.size(),
      Eigen::Matrix3Xd::Constant(3, static_cast<Eigen::Index>(rows.size()),
                                 std::numeric_limits<double>::quiet_NaN()));
  for (const int frame : frames)
    recording->markers.positions[frame] =
        frame == frames.front()
            ? recording->markers.places
            : Eigen::Matrix3Xd(PointsByRow(LoadFrame(*recording, frame))(Eigen::all, rows));
}

}  // namespace lacuna
