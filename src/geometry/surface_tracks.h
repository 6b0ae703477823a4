// Material points on a body's boundary, followed through its deformation.
#ifndef LACUNA_GEOMETRY_SURFACE_TRACKS_H_
#define LACUNA_GEOMETRY_SURFACE_TRACKS_H_

#include <Eigen/Core>

#include "geometry/nearest.h"
#include "geometry/tet_mesh.h"

namespace lacuna {

// Points (3 × n, m) seen at rest on or beside the boundary: each goes with the nearest place of the
// boundary, at the offset that it had at rest. A point at NaN stays at NaN.
struct SurfaceTracks {
  SurfaceHits at_rest;      // the places
  Eigen::Matrix3Xd offset;  // 3 × n, m, from place to point

  Eigen::Index Count() const { return offset.cols(); }
};
SurfaceTracks TrackOnSurface(const BoundarySurface& boundary, const Eigen::Matrix3Xd& points);

// The points when the mesh nodes are at `nodes` (3 × nodes, m).
Eigen::Matrix3Xd PointsAt(const SurfaceTracks& tracks, const BoundarySurface& boundary,
                          const Eigen::Matrix3Xd& nodes);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_SURFACE_TRACKS_H_
