#include <glog/logging.h>

#include <string>

#include "effects/catalogue.h"
#include "effects/elastic_parameters.h"
#include "effects/standard_cards.h"
#include "fem/cloneable_effect.h"
#include "fem/deformation_rates.h"
#include "fem/lame_constants.h"
#include "fem/point_integrals.h"

namespace lacuna {
namespace {

// S = 2μ Ė + λ (tr Ė) I,  Ė = sym(Fᵀ Ḟ)
Eigen::Matrix3d ViscousStress(const LameConstants& viscosity, const Eigen::Matrix3d& F,
                              const Eigen::Matrix3d& rate) {
  const Eigen::Matrix3d product = F.transpose() * rate;
  Eigen::Matrix3d stress = viscosity.mu * (product + product.transpose());
  stress.diagonal().array() += viscosity.lambda * product.trace();
  return stress;
}

// P = F S
Eigen::Matrix3d Stress(const LameConstants& viscosity, const Eigen::Matrix3d& F,
                       const Eigen::Matrix3d& rate) {
  return F * ViscousStress(viscosity, F, rate);
}

// Stiffness-proportional damping, the second term of Rayleigh damping, for large rotations and
// strains.
//
// The textbook force −β K v is unsuitable for a nonlinear body with any choice of K. With the
// stiffness of the rest shape it brakes a body that merely rotates (a rigid rotation is a null
// vector of K only about the rest position); with the current tangent it adds energy where that is
// indefinite. Here the elasticity at rest acts on the *rate of the Green–Lagrange strain* instead,
// as in a Kelvin–Voigt solid: rigid motions cause no force, the power −Ė : βC : Ė is never
// positive, and for small strains and rotations the force is −β K v for any elasticity law.
//
// The moduli are parameters of the effect, so that ∂f/∂(parameter) is complete. As long as they
// equal the material's, which they do by default, a fit changes both together, and the viscosity βC
// follows Young's modulus; moduli with other values stay as they are.
class StiffnessDampingEffect final : public CloneableEffect<StiffnessDampingEffect> {
 public:
  static const EffectCard& TheCard() {
    static const EffectCard card = MakeCard();
    return card;
  }

  explicit StiffnessDampingEffect(const Eigen::VectorXd& parameters) { SetParameters(parameters); }

  const EffectCard& Card() const override { return TheCard(); }
  Eigen::VectorXd Parameters() const override {
    return Eigen::Vector3d(beta_, young_modulus_, poisson_ratio_);
  }
  void SetParameters(const Eigen::VectorXd& values) {
    CHECK_EQ(values.size(), 3);
    beta_ = values[0];
    young_modulus_ = values[1];
    poisson_ratio_ = values[2];
  }

  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    if (!IsAtRest(at)) AddViscousForce(at, Viscosity(), force);
  }

  bool AddStress(const Kinematics& at, Eigen::Matrix3Xd* stress) const override {
    if (IsAtRest(at)) return true;
    const LameConstants viscosity = Viscosity();
    AddPointStress<DeformationRates>(
        at,
        [&](const auto& points, int k) { return Stress(viscosity, points.F(k), points.Rate(k)); },
        stress);
    return true;
  }

  // ∂P/∂Ḟ is symmetric, ∂P/∂F is not. With `convexify` the latter is omitted, because it is smaller
  // than ∂P/∂Ḟ by the strain increment of a step. The exact tangent needs both: a deformed body
  // that rotates is free of viscous stress only if the skew part of ∂P/∂F is included.
  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                   BlockMatrix* tangent) const override {
    const bool by_position = !convexify && weights.position != 0 && !IsAtRest(at);
    if (!by_position && weights.velocity == 0) return;
    const LameConstants viscosity = Viscosity();
    AddStiffnessMatrix<DeformationRates>(
        at, /*weight=*/1,
        [&](const auto& points, int k) {
          StressTangent C = weights.velocity * RateTangent(viscosity, points.F(k), points.F(k));
          if (by_position) {
            const StressTangent D = PositionTangent(viscosity, points.F(k), points.Rate(k));
            C += 0.5 * weights.position * (D + D.transpose());
          }
          return C;
        },
        tangent);
  }

  bool AddSkewTangents(const Kinematics& at, const TangentWeights& weights,
                       BlockMatrix* tangent) const override {
    if (weights.position == 0 || beta_ == 0 || IsAtRest(at)) return false;
    const LameConstants viscosity = Viscosity();
    AddStiffnessMatrix<DeformationRates, -1>(
        at, /*weight=*/1,
        [&](const auto& points, int k) {
          const StressTangent D = PositionTangent(viscosity, points.F(k), points.Rate(k));
          return StressTangent(0.5 * weights.position * (D - D.transpose()));
        },
        tangent);
    return true;
  }

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    CHECK(parameter >= 0 && parameter < 3);
    if (parameter == 0) {
      AddViscousForce(at, LameFromYoung(young_modulus_, poisson_ratio_), derivative);
    } else if (parameter == 1) {
      AddViscousForce(at, Scaled(beta_, LameByYoungModulus(poisson_ratio_)), derivative);
    } else {
      AddViscousForce(at, Scaled(beta_, LameByPoissonRatio(young_modulus_, poisson_ratio_)),
                      derivative);
    }
  }

 private:
  static EffectCard MakeCard() {
    EffectCard card{
        .type = "stiffness_damping",
        .family = EffectFamily::kLossInside,
        .title = "Stiffness-proportional damping (Kelvin–Voigt)",
        .equation =
            "P = F β (2μ Ė + λ (tr Ė) I),  Ė = ½ (FᵀḞ + ḞᵀF);  at small strain "
            "f = −β K v, damping ratio of a mode of angular frequency ω: βω/2",
        .citation =
            "J. W. Strutt, Baron Rayleigh, The Theory of Sound, vol. 1, 1877, §81–82; "
            "objective form: J. C. Simo, T. J. R. Hughes, Computational Inelasticity, "
            "Springer 1998, ch. 10",
        .parameters = {},
        .residual_when_missing =
            "The residual is a self-equilibrated force against the strain rate: fast modes decay "
            "much sooner than predicted, slow ones hardly.",
        .separating_experiment =
            "Compare the decay of two modes: here the decay rate grows as the square of the "
            "frequency, with mass-proportional damping it is the same. Strain the body and hold "
            "it: the stress relaxes at once, with a viscoelastic branch it takes the relaxation "
            "time",
        .look_alikes = {"mass_damping", "viscoelastic_branch", "elastoplastic_branch", "drag"},
        .trial = {.is_in_every_model = true},
        .conserves_momentum = true,
        .conserves_angular_momentum = true};
    card.parameters.push_back({.name = "beta",
                               .meaning = "time by which viscous stress leads elastic stress",
                               .dimension = kTime,
                               .bounds = kNotNegative,
                               .null_value = 0,
                               .plausible_min = 0,
                               .plausible_max = 0.05,
                               .default_value = kMustBeGiven,
                               .log_scale = false});
    for (ParameterCard parameter : ElasticParameters()) {
      parameter.meaning = "of the stiffness that β refers to (if omitted, that of the material): " +
                          parameter.meaning;
      card.parameters.push_back(std::move(parameter));
    }
    return card;
  }

  // Without a velocity, as in statics, there is no damping force at any strain.
  static bool IsAtRest(const Kinematics& at) { return at.velocity.isZero(0); }

  LameConstants Viscosity() const {
    return Scaled(beta_, LameFromYoung(young_modulus_, poisson_ratio_));
  }

  static LameConstants Scaled(double factor, const LameConstants& constants) {
    return {factor * constants.lambda, factor * constants.mu};
  }

  static void AddViscousForce(const Kinematics& at, const LameConstants& viscosity,
                              Eigen::VectorXd* force) {
    AddNodalForces<DeformationRates>(
        at,
        [&](const auto& points, int k) { return Stress(viscosity, points.F(k), points.Rate(k)); },
        force);
  }

  // ∂P/∂F at fixed Ḟ: the map δF ↦ δF S + F βC : sym(δFᵀ Ḟ).
  static StressTangent PositionTangent(const LameConstants& viscosity, const Eigen::Matrix3d& F,
                                       const Eigen::Matrix3d& rate) {
    StressTangent tangent = RateTangent(viscosity, F, rate);
    const Eigen::Matrix3d stress = ViscousStress(viscosity, F, rate);
    for (int j = 0; j < 3; ++j)
      for (int l = 0; l < 3; ++l)
        tangent.block<3, 3>(3 * j, 3 * l).diagonal().array() += stress(l, j);
    return tangent;
  }

  // The map δ ↦ F (2μ sym(Aᵀ δ) + λ tr(Aᵀ δ) I).
  static StressTangent RateTangent(const LameConstants& viscosity, const Eigen::Matrix3d& F,
                                   const Eigen::Matrix3d& A) {
    const Eigen::Map<const Eigen::Matrix<double, 9, 1>> f(F.data());
    const Eigen::Map<const Eigen::Matrix<double, 9, 1>> a(A.data());
    const Eigen::Matrix3d FAt = F * A.transpose();
    StressTangent tangent = viscosity.lambda * f * a.transpose();
    for (int l = 0; l < 3; ++l) {
      for (int j = 0; j < 3; ++j) {
        auto block = tangent.block<3, 3>(3 * j, 3 * l);
        block.noalias() += viscosity.mu * F.col(l) * A.col(j).transpose();
        if (l == j) block += viscosity.mu * FAt;
      }
    }
    return tangent;
  }

  double beta_ = 0;           // s
  double young_modulus_ = 0;  // Pa
  double poisson_ratio_ = 0;
};

}  // namespace

const EffectCard& StiffnessDampingCard() { return StiffnessDampingEffect::TheCard(); }

CatalogueEntry StiffnessDamping() {
  return {&StiffnessDampingEffect::TheCard(), CatalogueEntry::Kind::kEffect,
          &MakeAs<StiffnessDampingEffect>, &ReadParameters};
}

}  // namespace lacuna
