#include "reconstruction/point_noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/track_scatter.h"
#include "core/error.h"
#include "geometry/nearest.h"

namespace lacuna {
namespace {

// So many tracks determine the noise well.
constexpr Eigen::Index kMostNoiseTracks = 100;

// At most kMostNoiseTracks evenly chosen tracks (3 × chosen × states, m).
Eigen::MatrixXd SomeTracks(const std::vector<FrameState>& states) {
  const Eigen::Index count = states.front().tracked.cols();
  const Eigen::Index used = std::min(count, kMostNoiseTracks);
  Eigen::MatrixXd tracks(3 * used, static_cast<Eigen::Index>(states.size()));
  for (size_t k = 0; k < states.size(); ++k)
    for (Eigen::Index i = 0; i < used; ++i)
      tracks.col(static_cast<Eigen::Index>(k)).segment<3>(3 * i) =
          states[k].tracked.col(i * count / used);
  return tracks;
}

PointNoise NoiseOfTracks(const std::vector<FrameState>& states) {
  Eigen::VectorXd times(static_cast<Eigen::Index>(states.size()));
  for (size_t k = 0; k < states.size(); ++k) times[static_cast<Eigen::Index>(k)] = states[k].time;
  const TrackNoise found = EstimateTrackNoise(times, SomeTracks(states));
  if (std::isnan(found.deviation))
    throw InputError(
        "fit.noise must be given: the tracked points are not seen in three consecutive frames, "
        "from which it would be estimated");
  PointNoise noise{found.deviation, ""};
  if (!found.is_at_rest && found.deviation > 0)
    noise.warning = fmt::format(
        "fit.noise is not given; the estimate of {:.3g} mm is an upper bound, because the points "
        "do not rest in eight consecutive frames, and motion that is fast for the frame rate looks "
        "like noise",
        1e3 * found.deviation);
  return noise;
}

PointNoise NoiseOfCloud(const Eigen::Matrix3Xd& points) {
  if (points.cols() < kFewestNoisePoints)
    throw InputError(fmt::format(
        "fit.noise must be given: it would be estimated from planes through neighbouring points, "
        "of which the first frame has {}; at least {} are needed",
        points.cols(), kFewestNoisePoints));
  return {EstimateNoise(points), ""};
}

// The forces cannot bring a surface closer to later scans than it is to its own.
void AddErrorOfShape(const TriMesh& shape, const Eigen::Matrix3Xd& points, PointNoise* noise) {
  const Eigen::VectorXd distance = SurfaceSearch(shape).Nearest(points).distance;
  const double of_shape = std::sqrt(distance.squaredNorm() / static_cast<double>(distance.size()));
  constexpr double kMuchLarger = 2;  // beside a root mean square of about 1 from noise alone
  if (of_shape > kMuchLarger * noise->deviation)
    noise->warning = fmt::format(
        "the surface that was reconstructed from the first frame misses its own points by {:.3g} "
        "mm (rms), while they scatter by {:.3g} mm: the forces are fitted with both as noise, and "
        "contain what bends the surface back to its points. A mesh of the object (`reference`) or "
        "a finer surface (a smaller `surface: {{samples_per_node: …}}`, a larger `point_weight`) "
        "is more accurate",
        1e3 * of_shape, 1e3 * noise->deviation);
  noise->deviation = std::hypot(noise->deviation, of_shape);
}

}  // namespace

PointNoise EstimatePointNoise(const std::vector<FrameState>& states, bool are_identified,
                              const TriMesh& scanned_shape) {
  const Eigen::Matrix3Xd& points = states.front().cloud.points;
  PointNoise noise = are_identified ? NoiseOfTracks(states) : NoiseOfCloud(points);
  if (!are_identified && scanned_shape.triangles.cols() > 0)
    AddErrorOfShape(scanned_shape, points, &noise);
  constexpr double kLeast = 1e-5;
  noise.deviation = std::max(noise.deviation, kLeast * BoundingBoxDiagonal(points));
  return noise;
}

}  // namespace lacuna
