// Swelling or shrinking: without stress the body would be larger than its rest shape by a linear
// strain ε in all directions, because of the uptake of a liquid, heat (ε = α ΔT) or curing (ε < 0).
//
// The strain is free of the moduli: the deformation gradient is split into the swelling and an
// elastic part, F = F_e F_s with F_s = (1 + ε) I, and the elasticity law of the body, whichever it
// is and with its present parameters, stores energy for the elastic part only,
//   ψ = J_s ψ_el(F_e),  F_e = F/(1 + ε),  J_s = (1 + ε)³.
// This effect adds the difference to the energy that the law itself adds, ψ − ψ_el(F). A free body
// is larger by exactly ε; one that is held on all sides is under the pressure E ε/(1 − 2ν) to first
// order. As F/(1 + ε) is the deformation gradient of the positions x/(1 + ε), everything follows
// from the law at these positions: with s = 1 + ε and the law's force f_el, energy E_el and
// derivative K_el = ∂f_el/∂x,
//   f = s² f_el(x/s) − f_el(x),   E = s³ E_el(x/s) − E_el(x),   ∂f/∂x = s K_el(x/s) − K_el(x),
//   ∂f/∂ε = 2 s f_el(x/s) − K_el(x/s) x.
// Stresses of other effects (fibres, damping) refer to F, not to F_e.
#include <glog/logging.h>

#include "effects/catalogue.h"
#include "fem/cloneable_effect.h"

namespace lacuna {
namespace {

class SwellingEffect final : public CloneableEffect<SwellingEffect> {
 public:
  static const EffectCard& TheCard() {
    static const EffectCard card = MakeCard();
    return card;
  }

  explicit SwellingEffect(const Eigen::VectorXd& parameters) { SetParameters(parameters); }

  const EffectCard& Card() const override { return TheCard(); }
  Eigen::VectorXd Parameters() const override { return Eigen::VectorXd::Constant(1, strain_); }
  void SetParameters(const Eigen::VectorXd& values) {
    CHECK_EQ(values.size(), 1);
    CHECK_GT(values[0], -1);
    strain_ = values[0];
  }

  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    AddDifference(
        at, Stretch() * Stretch(),
        [&](const Kinematics& where, Eigen::VectorXd* of_law) { Law(at).AddForce(where, of_law); },
        force);
  }

  bool AddStress(const Kinematics& at, Eigen::Matrix3Xd* stress) const override {
    AddDifference(
        at, Stretch() * Stretch(),
        [&](const Kinematics& where, Eigen::Matrix3Xd* of_law) {
          Law(at).AddStress(where, of_law);
        },
        stress);
    return true;
  }

  // With `convexify` nothing: the law's own approximation stands for both.
  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                   BlockMatrix* tangent) const override {
    if (strain_ == 0 || weights.position == 0 || convexify) return;
    const ElasticPart elastic(at, Stretch());
    Law(at).AddTangents(elastic.kinematics, {.position = weights.position * Stretch()}, false,
                        tangent);
    Law(at).AddTangents(elastic.Unswollen(at), {.position = -weights.position}, false, tangent);
  }

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    CHECK_EQ(parameter, 0);
    const ElasticPart elastic(at, Stretch());
    Eigen::VectorXd of_law = Eigen::VectorXd::Zero(derivative->size());
    Law(at).AddForce(elastic.kinematics, &of_law);
    *derivative += 2 * Stretch() * of_law;
    BlockMatrix stiffness(at.body.pattern);
    Law(at).AddTangents(elastic.kinematics, {.position = 1}, false, &stiffness);
    stiffness.Multiply(at.position, &of_law);
    *derivative -= of_law;
  }

  void AddElasticityDerivative(const Kinematics& at, int parameter,
                               Eigen::VectorXd* derivative) const override {
    AddDifference(
        at, Stretch() * Stretch(),
        [&](const Kinematics& where, Eigen::VectorXd* of_law) {
          Law(at).AddParameterDerivative(where, parameter, of_law);
        },
        derivative);
  }

  std::optional<double> Energy(const Kinematics& at) const override {
    if (strain_ == 0) return 0.0;
    const ElasticPart elastic(at, Stretch());
    const std::optional<double> stored = Law(at).Energy(elastic.kinematics);
    const std::optional<double> unswollen = Law(at).Energy(elastic.Unswollen(at));
    if (!stored || !unswollen) return std::nullopt;
    return Stretch() * Stretch() * Stretch() * *stored - *unswollen;
  }

 private:
  // The state x/s at which the law sees the elastic part of the deformation. Elasticity laws have
  // no memory and do not depend on velocities.
  struct ElasticPart {
    ElasticPart(const Kinematics& at, double stretch)
        : position(at.position / stretch), kinematics{at.body,         position,     at.velocity,
                                                      at.acceleration, at.time,      at.time_step,
                                                      no_memory,       at.elasticity} {}
    ElasticPart(const ElasticPart&) = delete;
    ElasticPart& operator=(const ElasticPart&) = delete;

    Kinematics Unswollen(const Kinematics& at) const {
      return {at.body, at.position,  at.velocity, at.acceleration,
              at.time, at.time_step, no_memory,   at.elasticity};
    }

    const Eigen::VectorXd position, no_memory;
    const Kinematics kinematics;
  };

  static EffectCard MakeCard() {
    return {.type = "swelling",
            .family = EffectFamily::kVolumeStress,
            .title = "Swelling, shrinking or thermal expansion",
            .equation = "ψ = (1 + ε)³ ψ_el(F/(1 + ε)) − ψ_el(F),  ψ_el the body's elasticity law",
            .citation =
                "J. M. C. Duhamel, Second mémoire sur les phénomènes thermo-mécaniques, J. de "
                "l'École Polytechnique 15, 1837, 1–57; the multiplicative split: E. K. Rodriguez, "
                "A. Hoger, A. D. McCulloch, Stress-Dependent Finite Growth in Soft Elastic "
                "Tissues, Journal of Biomechanics 27, 1994, 455–467",
            .parameters = {{.name = "strain",
                            .meaning = "linear strain that the body would have if it were free, "
                                       "ε; negative where it shrinks",
                            .dimension = kDimensionless,
                            .bounds = {-1, 10, true, false},
                            .null_value = 0,
                            .plausible_min = -0.1,
                            .plausible_max = 0.1,
                            .default_value = kMustBeGiven}},
            .residual_when_missing =
                "Even without load the body is larger, or smaller, than its rest shape by the same "
                "ratio in all directions, and bulges beside a clamp that prevents its growth. The "
                "residual does not change with the load.",
            .separating_experiment =
                "Remove all load and turn the body upside down: swelling stays as it is, the sag "
                "of gravity changes sign. Free the clamp: a swollen body then has the same shape, "
                "only larger",
            .look_alikes = {"gravity", "active_contraction", "pressure"},
            .conserves_momentum = true,
            .conserves_angular_momentum = true};
  }

  double Stretch() const { return 1 + strain_; }

  static const Effect& Law(const Kinematics& at) {
    CHECK(at.elasticity != nullptr) << "swelling is relative to an elasticity law";
    return *at.elasticity;
  }

  // Adds scale · q(x/s) − q(x), where add(where, &q) adds nodal forces or stresses q of the law.
  template <typename Add, typename Values>
  void AddDifference(const Kinematics& at, double scale, const Add& add, Values* result) const {
    if (strain_ == 0) return;
    const ElasticPart elastic(at, Stretch());
    Values of_law = Values::Zero(result->rows(), result->cols());
    add(elastic.kinematics, &of_law);
    *result += scale * of_law;
    of_law.setZero();
    add(elastic.Unswollen(at), &of_law);
    *result -= of_law;
  }

  double strain_ = 0;  // ε
};

Eigen::VectorXd ReadSwelling(const EffectCard& card, const Config& config, const Effect* material) {
  for (const char* modulus : {"young_modulus", "poisson_ratio"})
    if (config.Has(modulus))
      config.Fail(modulus,
                  "is no longer needed: the strain is independent of the moduli, and those of the "
                  "material apply; leave it out");
  return ReadParameters(card, config, material);
}

}  // namespace

CatalogueEntry Swelling() {
  return {&SwellingEffect::TheCard(), CatalogueEntry::Kind::kEffect, &MakeAs<SwellingEffect>,
          &ReadSwelling};
}

}  // namespace lacuna
