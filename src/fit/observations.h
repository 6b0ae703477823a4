// Observations of one frame: measured positions of points of the body, with their uncertainties.
//
// Observation j compares the body point N_j x = Σ_a weight(a, j) x[node(a, j)] with a target y_j.
// The sum goes over the k corners of a triangle of the boundary, k = 3, or over the k nodes of a
// tetrahedron.
// Its whitened residual is W_j (N_j x − y_j), where the rows of W_j are the observed directions
// divided by their standard deviations. Lengths are in m.
#ifndef LACUNA_FIT_OBSERVATIONS_H_
#define LACUNA_FIT_OBSERVATIONS_H_

#include <Eigen/Core>
#include <limits>

#include "geometry/embedding.h"
#include "geometry/tet_mesh.h"

namespace lacuna {

inline constexpr double kUnobserved = std::numeric_limits<double>::infinity();

// The position is known to within `normal_sigma` along `normal` and to within `tangent_sigma`
// perpendicular to it; kUnobserved marks a direction that is not observed. Both are equal for a
// marker; a scanned point of a smooth surface is not observed in the tangential directions.
struct Observations {
  // k × m each; the columns of `weight` sum to 1. An observation of a single node has this node in
  // all rows of its column, with the weights 1, 0, …, 0.
  Eigen::MatrixXi node;
  Eigen::MatrixXd weight;
  Eigen::Matrix3Xd target;        // 3 × m
  Eigen::Matrix3Xd normal;        // 3 × m, unit length
  Eigen::VectorXd normal_sigma;   // m entries
  Eigen::VectorXd tangent_sigma;  // m entries

  Eigen::Index Count() const { return target.cols(); }
  // The number of different nodes of observation j, 1 or k; they come first in its column.
  Eigen::Index NodeCount(Eigen::Index j) const {
    return node(1, j) == node(0, j) ? 1 : node.rows();
  }
};

// The matrix W_j: one row along the normal and two rows perpendicular to it, as far as these
// directions are observed.
Eigen::Matrix<double, Eigen::Dynamic, 3> WhitenedDirections(const Observations& observations,
                                                            Eigen::Index j);

// The deviation N_j x − y_j, m, of the observed point at the node positions `x` (3n).
Eigen::Vector3d Deviation(const Observations& observations, Eigen::Index j,
                          const Eigen::VectorXd& x);

// The derivative N_j ∂x/∂p of Deviation (3 × K), from ∂x/∂p (3n × K).
Eigen::MatrixXd DeviationDerivative(const Observations& observations, Eigen::Index j,
                                    const Eigen::MatrixXd& x_by_p);

// All observations of `first`, then all of `second`, with the same k (CHECK).
Observations Concatenate(const Observations& first, const Observations& second);

// Observes, for each scanned point, the nearest point of the body's boundary at the node positions
// `x` (3 × n), along the normal of the boundary with standard deviation `sigma` > 0. On a sharp
// edge, which has no single normal, it is the direction between the two points. Points farther
// away than `reach`, and points whose own normal (if known) deviates by more than 60°, are left
// out, because they belong to another surface. All coordinates of the points must be finite
// (CHECK).
Observations ObserveScan(const BoundarySurface& boundary, const Eigen::Matrix3Xd& x,
                         const PointCloud& scan, double sigma, double reach);

// Observes each boundary vertex at `target` (3 × boundary vertices) with the given standard
// deviations along and perpendicular to the normal of the boundary at `x`. Vertices that are
// observed in no direction are left out.
Observations ObserveVertices(const BoundarySurface& boundary, const Eigen::Matrix3Xd& x,
                             const Eigen::Matrix3Xd& target, const Eigen::VectorXd& normal_sigma,
                             const Eigen::VectorXd& tangent_sigma);

// Observes markers, material points that `at_rest` locates in the undeformed `mesh` or beside it,
// in all directions with standard deviation `sigma`. Markers without a location, and those whose
// column of `target` contains NaN, because they were not seen, are left out.
Observations ObserveMarkers(const TetMesh& mesh, const Embedding& at_rest,
                            const Eigen::Matrix3Xd& target, double sigma);

}  // namespace lacuna

#endif  // LACUNA_FIT_OBSERVATIONS_H_
