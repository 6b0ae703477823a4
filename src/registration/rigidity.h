// Patches of the source surface: how they turn, and what their strain costs.
#ifndef LACUNA_REGISTRATION_RIGIDITY_H_
#define LACUNA_REGISTRATION_RIGIDITY_H_

#include <Eigen/Core>
#include <vector>

#include "registration/gaussian_basis.h"

namespace lacuna {

// Runs of `size` consecutive points (in spatial order) with the basis at their centres.
struct Patches {
  int size = 1;
  bool is_fine = false;        // of a basis that needs double precision
  Eigen::MatrixXd mean_basis;  // K × Q: the mean of φ over each patch's points
  Eigen::MatrixXd gradient[3];  // K × Q each: ∂φ/∂x, ∂φ/∂y, ∂φ/∂z at the patch's centre

  int Count() const { return static_cast<int>(mean_basis.cols()); }
};

// Between 400 and 800 patches, fewer for fewer points; one per point for a fine basis, of which
// means over points would hide the curvature.
Patches MakePatches(const GaussianBasis& basis, const Eigen::Matrix3Xd& points);

// F = I + ∇u of each patch, for coefficients 3 × K.
std::vector<Eigen::Matrix3d> DeformationGradients(const Patches& patches,
                                                  const Eigen::Matrix3Xd& coefficients);

// The rotation nearest to f (polar decomposition by Higham's iteration, 1986); the identity where f
// is singular.
Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& f);

// E(c) = 1/2Q Σ_q |F_q − R_q|², R_q the rotation nearest to F_q: the mean strain energy of the
// field on the surface ("as rigid as possible", Sorkine & Alexa 2007, in the basis of the field).
// Unlike motion coherence it costs nothing to bend and turn, only to stretch and shear, and so it
// decides how the surface moves within itself, which two independent samplings of it cannot tell.
//
// ∂E/∂c, 3 × K.
Eigen::Matrix3Xd RigidityGradient(const Patches& patches,
                                  const std::vector<Eigen::Matrix3d>& deformation_gradients);

// The Hessian of E at F = I with a small part of that of fixed rotations, so that it stays positive
// for turned patches: 3K × 3K, ordered (axis, k).
Eigen::MatrixXd RigidityHessian(const Patches& patches);

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_RIGIDITY_H_
