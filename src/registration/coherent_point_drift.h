// Non-rigid Coherent Point Drift (CPD): the smooth displacement that maps one cloud onto another.
//
// A. Myronenko and X. Song, "Point Set Registration: Coherent Point Drift", IEEE TPAMI 32, 2010:
// the target is modelled as a sample of a mixture of Gaussians centred at the displaced source
// points; expectation maximisation alternates between the probabilities of the pairs (posterior.h)
// and the displacement (motion_step.h). The implementation differs from the paper as follows:
//  - The kernel has low rank and is a function of space (gaussian_basis.h). The result is therefore
//    a field that can be evaluated anywhere, and memory is linear in the number of points.
//  - Pairs farther apart than a few σ are ignored, consistently in both sums.
//  - Residuals count along the normals of the source and hardly within its surface, because two
//    scans of one surface have no points in common; plain CPD would match the sampling densities.
//  - A strain energy (rigidity.h), in addition to motion coherence, determines the motion within
//    the surface. Both priors scale with the number of target points and the estimated noise.
//  - σ² is estimated from the distances along the normals, which converges in a few steps, and has
//    a lower bound at the point spacing. The fraction of outliers is estimated, too.
//  - The levels of a coarse-to-fine hierarchy of both clouds share one set of coefficients.
#ifndef LACUNA_REGISTRATION_COHERENT_POINT_DRIFT_H_
#define LACUNA_REGISTRATION_COHERENT_POINT_DRIFT_H_

#include <Eigen/Core>
#include <string>

#include "geometry/point_cloud.h"
#include "registration/cpd_options.h"
#include "registration/displacement_field.h"

namespace lacuna {

enum class CpdStatus {
  kNotRun,
  kConverged,
  kNoConvergence,  // max_iterations were reached on the last level; the field is the last iterate
  kTooFewPoints,   // one of the clouds has fewer than CpdResult::kFewestPoints points
  kNotFinite,      // a coordinate or a normal is NaN or infinite
  kNoExtent,       // the source points coincide or lie on a line
  kNoOverlap,      // almost no target point belongs to the source
};

// The result for M source points and N target points, in the order of the caller's clouds.
struct CpdResult {
  static constexpr int kFewestPoints = 8;

  CpdStatus status = CpdStatus::kNotRun;
  std::string message = "not run";
  bool IsUsable() const { return status == CpdStatus::kConverged; }

  DisplacementField field;
  Eigen::Matrix3Xd displaced;  // 3 × M, m: the source points, displaced by the field
  Eigen::VectorXd weight;  // M: number of target points assigned to each source point, Σ_n p_mn
  Eigen::VectorXd inlier;  // N: probability that each target point belongs to the source
  // Fraction of target points that belong to no source point, CpdOptions::kFewestOutliers …
  // kMostOutliers.
  double outlier_weight = 0.0;
  int iterations = 0;  // total over all levels
  int rank = 0;        // number of basis functions
};

// Registers `source` onto `target`. Normals of the source are used if given and estimated from its
// points otherwise; normals of the target are ignored. `warm_start` may be a field on about the
// same object, such as that of the previous frame. Bad clouds and failures give a status, never an
// exception; options out of their ranges are programming errors (CHECK). The result does not depend
// on the number of threads.
CpdResult RegisterNonrigid(const PointCloud& source, const PointCloud& target,
                           const CpdOptions& options = {},
                           const DisplacementField* warm_start = nullptr);

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_COHERENT_POINT_DRIFT_H_
