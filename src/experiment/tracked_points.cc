#include "experiment/tracked_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <variant>

#include "core/error.h"
#include "core/median.h"
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

// The entries of `values` by row, NaN for rows that the frame does not have.
Eigen::VectorXd ByRow(const Frame& frame, const Eigen::VectorXd& values) {
  Eigen::VectorXd by_row =
      Eigen::VectorXd::Constant(frame.row_count, std::numeric_limits<double>::quiet_NaN());
  if (values.size() > 0) by_row(frame.source_row) = values;
  return by_row;
}

// The weights of markers from the standard deviations (one vector per frame, NaN or 0 where none is
// given) that a program of image correlation expects. The programs count the noise of the images
// alone, not the errors of shape functions, lenses and calibration, so that one below a quarter of
// the median over all points and frames counts as that quarter. Larger: a few points dominate less;
// smaller: they are trusted more than any correlation deserves.
std::vector<Eigen::VectorXd> WeightsOf(const std::vector<Eigen::VectorXd>& sigma) {
  constexpr double kLeast = 0.25;
  std::vector<double> all;
  for (const Eigen::VectorXd& frame : sigma)
    for (const double value : frame)
      if (value > 0) all.push_back(value);
  if (all.empty()) return {};
  const double typical = Median(std::move(all));
  std::vector<Eigen::VectorXd> weights;
  for (const Eigen::VectorXd& frame : sigma) {
    weights.emplace_back(Eigen::VectorXd::Ones(frame.size()));
    // The reference image, correlated with itself, has no error at all.
    if (!(frame.array() > 0).any()) continue;
    for (Eigen::Index m = 0; m < frame.size(); ++m)
      if (frame[m] >= 0)
        weights.back()[m] = std::pow(typical / std::max(frame[m], kLeast * typical), 2);
  }
  return weights;
}

}  // namespace

void ConvertTrackedPointsToMarkers(const std::vector<int>& frames, Recording* recording) {
  const Frame first = LoadFrame(*recording, frames.front());
  const Eigen::Matrix3Xd places = PointsByRow(first);
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
      for (const int k : SelectPoints(grip.region, shown)) rows.push_back(seen[k]);
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
  std::vector<Eigen::VectorXd> sigma(recording->times.size());
  for (const int frame : frames) {
    const Frame shown = frame == frames.front() ? first : LoadFrame(*recording, frame);
    recording->markers.positions[frame] = PointsByRow(shown)(Eigen::all, rows);
    sigma[frame] = ByRow(shown, shown.sigma)(rows);
  }
  recording->markers.weights = WeightsOf(sigma);
}

Eigen::VectorXd TrackFactors(const Markers& markers, const std::vector<int>& frames) {
  Eigen::VectorXd factors = Eigen::VectorXd::Ones(markers.places.cols());
  if (markers.weights.empty() || frames.empty()) return factors;
  for (Eigen::Index m = 0; m < factors.size(); ++m) {
    double sum = 0;
    for (const int frame : frames) sum += markers.weights[frame][m];
    factors[m] = std::sqrt(sum / static_cast<double>(frames.size()));
  }
  return factors;
}

Eigen::MatrixXd WeightedTracks(const Markers& markers, const std::vector<int>& frames) {
  Eigen::MatrixXd rows(markers.places.size(), static_cast<Eigen::Index>(frames.size()));
  for (size_t k = 0; k < frames.size(); ++k)
    rows.col(static_cast<Eigen::Index>(k)) = markers.positions[frames[k]].reshaped();
  const Eigen::VectorXd factors = TrackFactors(markers, frames);
  for (Eigen::Index m = 0; m < factors.size(); ++m) rows.middleRows<3>(3 * m) *= factors[m];
  return rows;
}

}  // namespace lacuna
