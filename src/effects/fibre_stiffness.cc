// Parallel fibres, which make a body stiffer along their direction: transverse isotropy.
//
// The quadratic "standard reinforcing" energy of the fibres' stretch, k/8 (a·C·a − 1)², with
// C = FᵀF and the unit direction a in the rest shape. At small strain it is k/2 (a·ε·a)²: an extra
// Young's modulus k for a pull along the fibres and none for one across or for shear along them. It
// acts in tension and in compression.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "effects/catalogue.h"
#include "fem/point_energy_effect.h"

namespace lacuna {
namespace {

class FibreStiffnessLaw {
 public:
  enum Parameter { kModulus, kAzimuth, kInclination };

  static const EffectCard& Card() {
    static const EffectCard card = MakeCard();
    return card;
  }

  explicit FibreStiffnessLaw(const Eigen::VectorXd& parameters) : modulus_(parameters[kModulus]) {
    const double azimuth = parameters[kAzimuth], inclination = parameters[kInclination];
    const Eigen::Vector3d level(std::cos(azimuth), std::sin(azimuth), 0);
    const Eigen::Vector3d across(-std::sin(azimuth), std::cos(azimuth), 0);
    axis_ = std::cos(inclination) * level + std::sin(inclination) * Eigen::Vector3d::UnitZ();
    axis_by_azimuth_ = std::cos(inclination) * across;
    axis_by_inclination_ =
        -std::sin(inclination) * level + std::cos(inclination) * Eigen::Vector3d::UnitZ();
  }

  double EnergyDensity(const Eigen::Matrix3d& F, const MaterialPoint& /*at*/) const {
    const double elongation = Elongation(F * axis_);
    return modulus_ / 8 * elongation * elongation;
  }

  Eigen::Matrix3d Stress(const Eigen::Matrix3d& F, const MaterialPoint& /*at*/) const {
    return modulus_ * UnitStress(F);
  }

  // δP = k/2 (2 (b·δb) b + q δb) ⊗ a with b = F a, δb = δF a, q = b·b − 1. The map of δb has the
  // eigenvalues 3 b·b − 1 along b and q across b.
  StressTangent Tangent(const Eigen::Matrix3d& F, const MaterialPoint& /*at*/,
                        bool convexify) const {
    const Eigen::Vector3d b = F * axis_;
    double along = modulus_ / 2 * (3 * b.squaredNorm() - 1);
    double across = modulus_ / 2 * Elongation(b);
    if (convexify) {
      along = std::max(along, 0.0);
      across = std::max(across, 0.0);
    }
    const Eigen::Vector3d direction = b.normalized();
    Eigen::Matrix3d by_stretch = (along - across) * direction * direction.transpose();
    by_stretch.diagonal().array() += across;
    StressTangent tangent;
    for (int j = 0; j < 3; ++j) {
      for (int l = 0; l < 3; ++l) {
        tangent.block<3, 3>(3 * j, 3 * l) = axis_[j] * axis_[l] * by_stretch;
      }
    }
    return tangent;
  }

  Eigen::Matrix3d StressDerivative(const Eigen::Matrix3d& F, const MaterialPoint& /*at*/,
                                   int parameter) const {
    if (parameter == kModulus) return UnitStress(F);
    const Eigen::Vector3d turn = parameter == kAzimuth ? axis_by_azimuth_ : axis_by_inclination_;
    const Eigen::Vector3d b = F * axis_;
    const Eigen::Vector3d change = F * turn;
    const double elongation = Elongation(b);
    const Eigen::Vector3d tension = 2 * b.dot(change) * b + elongation * change;
    return modulus_ / 2 * (tension * axis_.transpose() + elongation * b * turn.transpose());
  }

 private:
  static EffectCard MakeCard() {
    EffectCard card{
        .type = "fibre_stiffness",
        .family = EffectFamily::kStiffnessDistribution,
        .title = "Stiffness along fibres (transverse isotropy)",
        .equation =
            "ψ = k/8 (a·C·a − 1)²,  C = FᵀF,  "
            "a = (cos θ cos φ, cos θ sin φ, sin θ) in the rest shape,  "
            "P = k/2 (a·C·a − 1) F a ⊗ a",
        .citation =
            "A. J. M. Spencer, Constitutive Theory for Strongly Anisotropic Solids, CISM Courses "
            "282, Springer 1984; standard reinforcing model: N. Triantafyllidis, R. Abeyaratne, "
            "J. Appl. Mech. 50, 1983, 149–156",
        .parameters = {},
        .residual_when_missing =
            "Stretch along one direction of the body is predicted too large, stretch across it is "
            "predicted well. Under a load oblique to the fibres the body also shears or twists, "
            "which no isotropic law can explain.",
        .separating_experiment =
            "Turn the body by 90° about the load and load it again: with fibres the response "
            "changes; with a stiffness that varies in space the residual rotates with the body",
        .look_alikes = {"strain_stiffening", "inclusion", "stiffness_gradient",
                        "active_contraction"},
        .tried_at = TriedAlongDirections{},
        .repeatable = true,
        .conserves_momentum = true,
        .conserves_angular_momentum = true};
    card.parameters.push_back({.name = "modulus",
                               .meaning = "extra Young's modulus along the fibres at small strain, "
                                          "k; negative where this direction is the softer one",
                               .dimension = kPressure,
                               .bounds = kAnyValue,
                               .null_value = 0,
                               .plausible_min = -1e5,
                               .plausible_max = 1e6,
                               .of_body = true,
                               .default_value = kMustBeGiven});
    card.parameters.push_back({.name = "azimuth",
                               .meaning =
                                   "angle from the x axis to the projection of the fibres "
                                   "onto the xy plane, φ; without meaning for fibres along z",
                               .dimension = kAngle,
                               .bounds = kAnyValue,
                               .null_value = kNoNullValue,
                               .plausible_min = -std::numbers::pi / 2,
                               .plausible_max = std::numbers::pi / 2,
                               .default_value = 0,
                               .trial = {.min = -1.2, .max = 1.2, .draw = 4}});
    card.parameters.push_back({.name = "inclination",
                               .meaning = "angle of the fibres above the xy plane, θ",
                               .dimension = kAngle,
                               .bounds = kAnyValue,
                               .null_value = kNoNullValue,
                               .plausible_min = -std::numbers::pi / 2,
                               .plausible_max = std::numbers::pi / 2,
                               .default_value = 0,
                               .trial = {.min = -1.2, .max = 1.2, .draw = 5}});
    return card;
  }

  static double Elongation(const Eigen::Vector3d& stretched) { return stretched.squaredNorm() - 1; }

  // The stress for k = 1.
  Eigen::Matrix3d UnitStress(const Eigen::Matrix3d& F) const {
    const Eigen::Vector3d b = F * axis_;
    return 0.5 * Elongation(b) * b * axis_.transpose();
  }

  double modulus_;        // k, Pa
  Eigen::Vector3d axis_;  // a, unit length
  Eigen::Vector3d axis_by_azimuth_, axis_by_inclination_;
};

}  // namespace

CatalogueEntry FibreStiffness() {
  return {&FibreStiffnessLaw::Card(), CatalogueEntry::Kind::kEffect,
          &MakeAs<PointEnergyEffect<FibreStiffnessLaw>>, &ReadParameters};
}

}  // namespace lacuna
