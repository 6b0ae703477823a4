// The M-step of Coherent Point Drift, weighted by the normals of the source.
#ifndef LACUNA_REGISTRATION_MOTION_STEP_H_
#define LACUNA_REGISTRATION_MOTION_STEP_H_

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "registration/basis_table.h"
#include "registration/posterior.h"
#include "registration/rigidity.h"

namespace lacuna {

// What the M-step minimises over the coefficients c of the displacement, for fixed p_mn:
//
//   1/2 Σ_m P_m [ (1 − ε) (n_m·(d_m − u_m) − b_m)² + ε |d_m − u_m|² ]
//     + τ² N (λ/2 |c|² + μ E(c))
//
// with P_m d_m = Σ_n p_mn (x_n − y_m), u_m the displacement, n_m the turned normal of the source, E
// the rigidity and τ² a variance between σ² and that of the residuals. ε = 1 with μ = 0 and τ = σ
// is Myronenko & Song 2010, Eq. 22, in a low-rank basis. The mean d_m of the points around a curved
// surface lies off it by b_m, and the source shows by how much: b_m is what the source's posterior
// against itself gives. A source point whose normal is unknown (0) counts with its whole distance.
struct MotionObjective {
  double tangential_weight = 0.003;  // ε
  double coherence = 0.0;            // τ² N λ
  double rigidity = 0.0;             // τ² N μ
};

// The source of one level, in spatial order.
struct SourceSurface {
  Eigen::Matrix3Xd normals;        // at rest: 3 × M
  Eigen::VectorXd curvature_bias;  // M: b / σ²
  Patches patches;
};

// Pulls of the M source points at the present coefficients: −∂/∂u of the first sum.
struct Pull {
  Eigen::Matrix3Xf force;  // 3 × M
  double residual = 0.0;   // rms of the distances along the normals, weighted by P
  std::vector<Eigen::Matrix<double, 6, 1>> weights;  // Q: Σ P W per patch: xx, xy, xz, yy, yz, zz
};
Pull PullOf(const SourceSurface& source, const std::vector<Eigen::Matrix3d>& deformation_gradients,
            const Posterior& posterior, double sigma, const MotionObjective& objective);

// The Hessian of the objective with φ averaged over patches: 3K × 3K, ordered (axis, k), lower
// half. The averaging makes it cheap; the gradient is exact, so that it only sets the pace.
Eigen::MatrixXd MotionHessian(const SourceSurface& source, const Pull& pull,
                              const Eigen::MatrixXd& rigidity_hessian,
                              const MotionObjective& objective);

// One Newton step: H⁻¹ (−gradient), 3 × K.
Eigen::Matrix3Xd MotionStep(const SourceSurface& source, const BasisTable& table, const Pull& pull,
                            const Eigen::Matrix3Xd& coefficients,
                            const std::vector<Eigen::Matrix3d>& deformation_gradients,
                            const MotionObjective& objective,
                            const Eigen::LLT<Eigen::MatrixXd>& hessian);

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_MOTION_STEP_H_
