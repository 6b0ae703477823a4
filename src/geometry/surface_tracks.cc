#include "geometry/surface_tracks.h"

namespace lacuna {

SurfaceTracks TrackOnSurface(const BoundarySurface& boundary, const Eigen::Matrix3Xd& points) {
  SurfaceTracks tracks;
  tracks.at_rest = SurfaceSearch(boundary.surface).Nearest(points);
  tracks.offset = points - tracks.at_rest.point;
  return tracks;
}

Eigen::Matrix3Xd PointsAt(const SurfaceTracks& tracks, const BoundarySurface& boundary,
                          const Eigen::Matrix3Xd& nodes) {
  Eigen::Matrix3Xd points = tracks.offset;
  for (Eigen::Index j = 0; j < points.cols(); ++j) {
    if (tracks.at_rest.triangle[j] < 0) continue;  // a point that is not finite: the offset is NaN
    const Eigen::Vector3i triangle = boundary.surface.triangles.col(tracks.at_rest.triangle[j]);
    for (int a = 0; a < 3; ++a)
      points.col(j) += tracks.at_rest.barycentric(a, j) * nodes.col(boundary.node[triangle[a]]);
  }
  return points;
}

}  // namespace lacuna
