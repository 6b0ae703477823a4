// A compressible neo-Hookean solid whose energy is a polynomial of F, and therefore finite and
// smooth for flattened and inverted elements too.
//
// The volumetric part is that of B. Smith, F. de Goes & T. Kim, Stable Neo-Hookean Flesh
// Simulation, ACM TOG 37(2), 2018, Eq. 13, with the rest state at J = 1 and constants chosen so
// that λ and μ are the Lamé constants at small strain. Their additional term log(I_C + 1) is
// omitted: it removes a shallow local minimum at F = 0 (all nodes of an element in one point), but
// it lets the shear stiffness grow with stretch (to 4/3 μ in the limit), so that the law would not
// be neo-Hookean: an incompressible bar at twice its length would be 11 % too stiff.
#ifndef LACUNA_EFFECTS_NEO_HOOKEAN_ENERGY_H_
#define LACUNA_EFFECTS_NEO_HOOKEAN_ENERGY_H_

#include <Eigen/Core>

#include "effects/strain_invariants.h"
#include "fem/lame_constants.h"
#include "fem/polar_decomposition.h"
#include "fem/stress_tangent.h"

namespace lacuna {

//   ψ = μ/2 (F:F − 3) − μ (J − 1) + (λ + μ)/2 (J − 1)²,    P = μ F + ((λ + μ)(J − 1) − μ) ∂J/∂F
// in J/m³ and Pa, with J = det F. Both are linear in λ and μ (Pa), which may be negative to
// describe a reduced stiffness.
class NeoHookeanEnergy {
 public:
  explicit NeoHookeanEnergy(const LameConstants& lame) : lame_(lame) {}

  double EnergyDensity(const Eigen::Matrix3d& F) const {
    const auto [distortion, dilatation] = InvariantsOf(F);
    return 0.5 * lame_.mu * distortion + 0.5 * (lame_.lambda + lame_.mu) * dilatation * dilatation;
  }

  Eigen::Matrix3d Stress(const Eigen::Matrix3d& F) const {
    const Eigen::Matrix3d cofactor = Cofactor(F);
    return lame_.mu * F + VolumetricSlope(F.col(0).dot(cofactor.col(0))) * cofactor;
  }

  // ∂P/∂F (9 × 9, column-major in F and P), Pa; with `convexify` its projection onto the positive
  // semi-definite matrices.
  StressTangent Tangent(const Eigen::Matrix3d& F, bool convexify) const {
    const Eigen::Matrix3d cofactor = Cofactor(F);
    const double slope = VolumetricSlope(F.col(0).dot(cofactor.col(0)));
    const Eigen::Map<const Eigen::Matrix<double, 9, 1>> c(cofactor.data());
    StressTangent tangent = (lame_.lambda + lame_.mu) * c * c.transpose();
    tangent.diagonal().array() += lame_.mu;
    AddCofactorDerivative(F, slope, &tangent);
    if (!convexify || IsPositiveSemidefinite(tangent)) return tangent;
    return Projected(F);
  }

 private:
  // ∂ψ/∂J at fixed F:F.
  double VolumetricSlope(double J) const { return (lame_.lambda + lame_.mu) * (J - 1) - lame_.mu; }

  StressTangent Projected(const Eigen::Matrix3d& F) const {
    const SignedSvd axes = ComputeSignedSvd(F);
    PrincipalTangent principal = PrincipalTangent::Zero();
    principal.AddIsotropic(lame_.mu);
    principal.AddVolumetric(axes.stretch, VolumetricSlope(axes.stretch.prod()),
                            lame_.lambda + lame_.mu);
    return ProjectedTangent(axes, principal);
  }

  LameConstants lame_;
};

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_NEO_HOOKEAN_ENERGY_H_
