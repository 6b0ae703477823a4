// The strain energy of the source surface, evaluated on small patches.
#ifndef LACUNA_REGISTRATION_RIGIDITY_H_
#define LACUNA_REGISTRATION_RIGIDITY_H_

#include <Eigen/Core>
#include <vector>

#include "registration/gaussian_basis.h"

namespace lacuna {

// Q runs of `size` consecutive points (in spatial order) with the basis at their centres.
struct Patches {
  int size = 1;
  bool is_fine = false;        // whether the basis needs double precision (GaussianBasis::IsFine)
  Eigen::MatrixXd mean_basis;  // K × Q: the mean of φ over each patch's points
  Eigen::MatrixXd gradient[3];  // K × Q each: ∂φ/∂x, ∂φ/∂y, ∂φ/∂z at the patch's centre

  int Count() const { return static_cast<int>(mean_basis.cols()); }
};

// Divides the points into 400 to 800 patches, fewer for fewer points. A fine basis gets one patch
// per point, because averages over points would hide its curvature.
Patches MakePatches(const GaussianBasis& basis, const Eigen::Matrix3Xd& points);

// The deformation gradients F = I + ∇u of the patches for the coefficients of u (3 × K).
std::vector<Eigen::Matrix3d> DeformationGradients(const Patches& patches,
                                                  const Eigen::Matrix3Xd& coefficients);

// The rotation nearest to f in the Frobenius norm (polar decomposition by the iteration of N. J.
// Higham, 1986); the identity if f is singular or a reflection.
Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& f);

// The gradient ∂E/∂c (3 × K) of the mean strain energy
//   E(c) = 1/2Q Σ_q |F_q − R_q|²,   R_q the rotation nearest to F_q,
// of the field on the surface ("as rigid as possible", O. Sorkine and M. Alexa, SGP 2007, in the
// basis of the field). Unlike motion coherence it penalises only stretch and shear, not bending and
// rotation. It thus determines the motion within the surface, about which two independent scans
// contain no information.
Eigen::Matrix3Xd RigidityGradient(const Patches& patches,
                                  const std::vector<Eigen::Matrix3d>& deformation_gradients);

// The Hessian of E at F = I (3K × 3K, ordered (axis, k)), with a small fraction of the Hessian for
// fixed rotations so that it remains positive definite for rotated patches.
Eigen::MatrixXd RigidityHessian(const Patches& patches);

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_RIGIDITY_H_
