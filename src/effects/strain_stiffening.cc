// Stiffening with strain, as in soft tissue and in rubber whose chains approach their full length:
// the second term of Yeoh's energy.
//
// Yeoh's invariant Ī₁ − 3 = J^(−2/3) F:F − 3 is singular where an element is flat. Here a
// polynomial of F replaces it,
//   I = F:F − 3 − 2 (J − 1) + (J − 1)²/3,
// which equals Ī₁ − 3 where J = 1. Like Ī₁ − 3 it is 2 e:e to second order in the strain, with the
// strain deviator e. Hence I² is of fourth order (of sixth order in a pure change of volume): the
// effect does not change the moduli of the material at small strain.
#include <Eigen/LU>

#include "effects/catalogue.h"
#include "effects/strain_invariants.h"
#include "fem/point_energy_effect.h"

namespace lacuna {
namespace {

class StrainStiffeningLaw {
 public:
  static const EffectCard& Card() {
    static const EffectCard card{
        .type = "strain_stiffening",
        .family = EffectFamily::kElasticity,
        .title = "Stiffening with strain (Yeoh's second term)",
        .equation =
            "ψ = c I²,  I = F:F − 3 − 2 (J − 1) + (J − 1)²/3 (= Ī₁ − 3 at J = 1),  J = det F,  "
            "P = 2 c I ∂I/∂F",
        .citation =
            "O. H. Yeoh, Some Forms of the Strain Energy Function for Rubber, Rubber Chemistry and "
            "Technology 66(5), 1993, 754–771",
        .parameters = {{.name = "modulus",
                        .meaning = "energy density per squared strain invariant, c; an eighth of "
                                   "the shear modulus doubles the force at twice the length",
                        .dimension = kPressure,
                        .bounds = kNotNegative,
                        .null_value = 0,
                        .plausible_min = 0,
                        .plausible_max = 1e5,
                        .of_body = true,
                        .default_value = kMustBeGiven}},
        .residual_when_missing =
            "Small loads are predicted well, large ones are not: the measured displacement falls "
            "more and more behind the prediction, most where the body is stretched or sheared "
            "most, in tension and compression alike.",
        .separating_experiment =
            "Double and treble the load: the missing force grows as the third power of the strain, "
            "that of an additional linear stiffness in proportion to it",
        .look_alikes = {"linear", "corotational", "st_venant_kirchhoff", "neo_hookean",
                        "fibre_stiffness"},
        .conserves_momentum = true,
        .conserves_angular_momentum = true};
    return card;
  }

  explicit StrainStiffeningLaw(const Eigen::VectorXd& parameters) : modulus_(parameters[0]) {}

  double EnergyDensity(const Eigen::Matrix3d& F, const MaterialPoint& /*at*/) const {
    const double I = Invariant(F);
    return modulus_ * I * I;
  }

  Eigen::Matrix3d Stress(const Eigen::Matrix3d& F, const MaterialPoint& /*at*/) const {
    return 2 * modulus_ * Invariant(F) * InvariantDerivative(F, Cofactor(F));
  }

  // 2c (∂I/∂F ⊗ ∂I/∂F + I ∂²I/∂F²)
  StressTangent Tangent(const Eigen::Matrix3d& F, const MaterialPoint& /*at*/,
                        bool convexify) const {
    const double I = Invariant(F);
    const Eigen::Matrix3d cofactor = Cofactor(F);
    const Eigen::Matrix3d slope = InvariantDerivative(F, cofactor);
    const Eigen::Map<const Eigen::Matrix<double, 9, 1>> c(cofactor.data());
    const Eigen::Map<const Eigen::Matrix<double, 9, 1>> p(slope.data());
    StressTangent tangent = 2 * modulus_ * p * p.transpose();
    tangent += 2 * modulus_ * I * kVolume * c * c.transpose();
    tangent.diagonal().array() += 4 * modulus_ * I;
    AddCofactorDerivative(F, 2 * modulus_ * I * VolumeDerivative(F.determinant()), &tangent);
    if (!convexify || IsPositiveSemidefinite(tangent)) return tangent;
    return Projected(F, I);
  }

  Eigen::Matrix3d StressDerivative(const Eigen::Matrix3d& F, const MaterialPoint& /*at*/,
                                   int /*parameter*/) const {
    return 2 * Invariant(F) * InvariantDerivative(F, Cofactor(F));
  }

 private:
  static constexpr double kVolume = 2.0 / 3;  // ∂²I/∂J² at fixed F:F

  static double Invariant(const Eigen::Matrix3d& F) {
    const auto [distortion, dilatation] = InvariantsOf(F);
    return distortion + 0.5 * kVolume * dilatation * dilatation;
  }

  // ∂I/∂J at fixed F:F.
  static double VolumeDerivative(double J) { return kVolume * (J - 1) - 2; }

  static Eigen::Matrix3d InvariantDerivative(const Eigen::Matrix3d& F,
                                             const Eigen::Matrix3d& cofactor) {
    return 2 * F + VolumeDerivative(F.col(0).dot(cofactor.col(0))) * cofactor;
  }

  StressTangent Projected(const Eigen::Matrix3d& F, double I) const {
    const SignedSvd axes = ComputeSignedSvd(F);
    const Eigen::Vector3d& s = axes.stretch;
    const double volume_derivative = VolumeDerivative(s.prod());
    const Eigen::Vector3d slope =
        2 * s +
        volume_derivative * Eigen::Vector3d(s[1] * s[2], s[2] * s[0], s[0] * s[1]);  // ∂I/∂s
    const double by_invariant = 2 * modulus_ * I;
    PrincipalTangent principal = PrincipalTangent::Zero();
    principal.stretch = 2 * modulus_ * slope * slope.transpose();
    principal.AddIsotropic(2 * by_invariant);
    principal.AddVolumetric(s, by_invariant * volume_derivative, by_invariant * kVolume);
    return ProjectedTangent(axes, principal);
  }

  double modulus_;  // c, Pa
};

}  // namespace

CatalogueEntry StrainStiffening() {
  return {&StrainStiffeningLaw::Card(), CatalogueEntry::Kind::kEffect,
          &MakeAs<PointEnergyEffect<StrainStiffeningLaw>>, &ReadParameters};
}

}  // namespace lacuna
