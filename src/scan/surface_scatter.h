// How far the points of a cloud scatter about the surface that they show.
//
// The surface at a point is the quadric through its k nearest neighbours, without the point itself,
//   h(u, v) = a + b u + c v + d u² + e u v + f v²,
// fitted by least squares over the plane of their principal axes, with the origin at the point. The
// point then lies −a off the surface. Where all points scatter along the normal with the standard
// deviation σ, this distance has the variance σ² (1 + g), where g is the first diagonal entry of
// (XᵀX)⁻¹ and the rows of X are (1, u, v, u², uv, v²); this corrects for the degrees of freedom of
// the fit. σ is 1.4826 times the median of |a|/√(1 + g) (the median absolute deviation, consistent
// for the normal distribution), so that outliers and edges hardly count.
//
// The quadric removes the curvature. Where the object has finer shape than its points resolve, the
// distance grows with the neighbourhood, while that of scatter alone does not: two sizes tell the
// cases apart.
#ifndef LACUNA_SCAN_SURFACE_SCATTER_H_
#define LACUNA_SCAN_SURFACE_SCATTER_H_

#include <Eigen/Core>
#include <limits>

namespace lacuna {

struct SurfaceScatter {
  // σ, m; NaN where there are too few points, or where they lie along lines.
  double deviation = std::numeric_limits<double>::quiet_NaN();
  // Whether the deviation includes shape that the points do not resolve.
  bool is_upper_bound = false;
  double spacing = 0;  // m, the square root of the area per point
  // The share of points farther off the surface than five standard deviations: of all points, of
  // their own neighbours (which scatter more at edges), and of a tenth of the spacing (below which
  // a point does no harm).
  double outlier_share = 0;
  double farthest = 0;  // m, the largest distance of such a point from the surface; 0 without any
};

// `points`: 3 × n, finite, m. `seen_by`: n, the camera that saw each point; the neighbours of a
// point are then those that the same camera saw, so that a misalignment of the cameras is not
// counted as scatter. Empty: all belong together. At most some two thousand points, one from each
// of as many equal parts of the cloud, are examined; the same ones at each call.
SurfaceScatter MeasureSurfaceScatter(const Eigen::Matrix3Xd& points,
                                     const Eigen::VectorXi& seen_by = {});

}  // namespace lacuna

#endif  // LACUNA_SCAN_SURFACE_SCATTER_H_
