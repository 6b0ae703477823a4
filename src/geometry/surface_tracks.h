// Material points on or near the boundary of a body, which follow its deformation.
#ifndef LACUNA_GEOMETRY_SURFACE_TRACKS_H_
#define LACUNA_GEOMETRY_SURFACE_TRACKS_H_

#include <Eigen/Core>

#include "geometry/nearest.h"
#include "geometry/tet_mesh.h"

namespace lacuna {

// Points attached to the nearest point of the undeformed boundary by a constant offset.
struct SurfaceTracks {
  SurfaceHits at_rest;      // the nearest points of the undeformed boundary
  Eigen::Matrix3Xd offset;  // 3 × n, m: from the nearest boundary point to the tracked point

  Eigen::Index Count() const { return offset.cols(); }
};
// Attaches `points` (3 × n, m, in the reference configuration). The boundary must have a triangle
// (CHECK). A point at NaN stays at NaN.
SurfaceTracks TrackOnSurface(const BoundarySurface& boundary, const Eigen::Matrix3Xd& points);

// The positions of the points (3 × n, m) for the node positions `nodes` (3 × nodes, m). Offsets are
// not rotated with the surface.
Eigen::Matrix3Xd PointsAt(const SurfaceTracks& tracks, const BoundarySurface& boundary,
                          const Eigen::Matrix3Xd& nodes);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_SURFACE_TRACKS_H_
