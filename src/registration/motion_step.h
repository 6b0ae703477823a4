// The M-step of Coherent Point Drift, with residuals along the normals of the source.
#ifndef LACUNA_REGISTRATION_MOTION_STEP_H_
#define LACUNA_REGISTRATION_MOTION_STEP_H_

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "registration/basis_table.h"
#include "registration/posterior.h"
#include "registration/rigidity.h"

namespace lacuna {

// The M-step minimises over the coefficients c of the displacement, for fixed p_mn:
//
//   1/2 Σ_m P_m [ (1 − ε) (n_m·(d_m − u_m) − b_m)² + ε |d_m − u_m|² ]
//     + τ² N (λ/2 |c|² + μ E(c))
//
// with P_m d_m = Σ_n p_mn (x_n − y_m), the displacement u_m, the rotated normal n_m of the source,
// the strain energy E (rigidity.h) and a variance τ² between σ² and that of the residuals. ε = 1,
// μ = 0 and τ = σ give Myronenko & Song 2010, Eq. 22, in a low-rank basis. The mean of points
// around a curved surface is off the surface by b_m (curvature bias), which is measured by the
// posterior of the source against itself. A source point without a normal (0) counts with its full
// distance.
struct MotionObjective {
  double tangential_weight = 0.003;  // ε
  double coherence = 0.0;            // τ² N λ
  double rigidity = 0.0;             // τ² N μ
};

// The source of one level, in spatial order.
struct SourceSurface {
  Eigen::Matrix3Xd normals;        // 3 × M, unit length or 0, at rest
  Eigen::VectorXd curvature_bias;  // M: b / σ²
  Patches patches;
};

// The forces on the M source points at the current coefficients: −∂/∂u of the first sum.
struct Pull {
  Eigen::Matrix3Xf force;  // 3 × M
  double residual = 0.0;   // rms of the distances along the normals, weighted by P
  // Q patches: the sum over each patch of P_m ((1 − ε) n nᵀ + ε I) as xx, xy, xz, yy, yz, zz.
  std::vector<Eigen::Matrix<double, 6, 1>> weights;
};
// `deformation_gradients` (one per patch) rotate the normals.
Pull PullOf(const SourceSurface& source, const std::vector<Eigen::Matrix3d>& deformation_gradients,
            const Posterior& posterior, double sigma, const MotionObjective& objective);

// The Hessian of the objective (3K × 3K, ordered (axis, k), lower half) with φ averaged over each
// patch. The averaging makes it cheap; since the gradient is exact, it affects only the speed of
// convergence.
Eigen::MatrixXd MotionHessian(const SourceSurface& source, const Pull& pull,
                              const Eigen::MatrixXd& rigidity_hessian,
                              const MotionObjective& objective);

// The Newton step −H⁻¹ · gradient of the objective, 3 × K.
Eigen::Matrix3Xd MotionStep(const SourceSurface& source, const BasisTable& table, const Pull& pull,
                            const Eigen::Matrix3Xd& coefficients,
                            const std::vector<Eigen::Matrix3d>& deformation_gradients,
                            const MotionObjective& objective,
                            const Eigen::LLT<Eigen::MatrixXd>& hessian);

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_MOTION_STEP_H_
