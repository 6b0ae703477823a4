// What one frame says about where points of the body are.
#ifndef LACUNA_FIT_OBSERVATIONS_H_
#define LACUNA_FIT_OBSERVATIONS_H_

#include <Eigen/Core>
#include <limits>

#include "geometry/nearest.h"
#include "geometry/tet_mesh.h"

namespace lacuna {

inline constexpr double kUnobserved = std::numeric_limits<double>::infinity();

// Observation j says that the body's point Σ_a weight(a, j)·x[node(a, j)] lies at target.col(j), to
// within `normal_sigma` along `normal` and `tangent_sigma` across it (m; kUnobserved: says
// nothing). A marker has both equal; a scanned point of a smooth surface says nothing across its
// normal.
struct Observations {
  Eigen::MatrixXi node;     // 3 × m
  Eigen::MatrixXd weight;   // 3 × m, columns sum to 1
  Eigen::Matrix3Xd target;  // 3 × m, m
  Eigen::Matrix3Xd normal;  // 3 × m, unit length
  Eigen::VectorXd normal_sigma;
  Eigen::VectorXd tangent_sigma;

  Eigen::Index Count() const { return target.cols(); }
};

// The observed directions of observation j, each divided by its standard deviation: rows of a
// matrix R, so that R (N x − y) is the whitened residual. One row along the normal, two across it,
// where those are observed.
Eigen::Matrix<double, Eigen::Dynamic, 3> WhitenedDirections(const Observations& observations,
                                                            Eigen::Index j);

Observations Concatenate(const Observations& first, const Observations& second);

// Each scanned point observes the nearest point of the body's boundary at the node positions `x`
// (3 × n), along the boundary's normal there. Points farther than `reach` (m), and points whose own
// normal (where known) turns more than 60° away, observe nothing: they belong to something else.
Observations ObserveScan(const BoundarySurface& boundary, const Eigen::Matrix3Xd& x,
                         const PointCloud& scan, double sigma, double reach);

// Each boundary vertex is observed at `target` (3 × boundary vertices) with the given uncertainties
// (m) along and across the boundary's normal at `x`. A weight of 0 drops the vertex.
Observations ObserveVertices(const BoundarySurface& boundary, const Eigen::Matrix3Xd& x,
                             const Eigen::Matrix3Xd& target, const Eigen::VectorXd& normal_sigma,
                             const Eigen::VectorXd& tangent_sigma);

// Points fixed to the body's boundary at rest (markers), observed in all directions; a column of
// `target` with NaN was not seen.
Observations ObserveMarkers(const BoundarySurface& boundary, const SurfaceHits& at_rest,
                            const Eigen::Matrix3Xd& target, double sigma);

}  // namespace lacuna

#endif  // LACUNA_FIT_OBSERVATIONS_H_
