// Mass-proportional damping, the first term of Rayleigh damping.
#include <glog/logging.h>

#include "effects/catalogue.h"
#include "effects/standard_cards.h"
#include "fem/cloneable_effect.h"

namespace lacuna {
namespace {

class MassDampingEffect final : public CloneableEffect<MassDampingEffect> {
 public:
  static const EffectCard& TheCard() {
    static const EffectCard card{
        .type = "mass_damping",
        .family = EffectFamily::kLossOutside,
        .title = "Mass-proportional damping",
        .equation = "f_i = −α m_i v_i;  damping ratio of a mode of angular frequency ω: α/(2ω)",
        .citation = "J. W. Strutt, Baron Rayleigh, The Theory of Sound, vol. 1, 1877, §81–82",
        .parameters = {{.name = "alpha",
                        .meaning = "rate at which free motion in the laboratory frame decays",
                        .dimension = kRate,
                        .bounds = kNotNegative,
                        .null_value = 0,
                        .plausible_min = 0,
                        .plausible_max = 20,
                        .of_body = true,
                        .default_value = kMustBeGiven,
                        .log_scale = false}},
        .residual_when_missing =
            "The residual is a force against the velocity, proportional to mass: the amplitudes of "
            "all modes, and of rigid motion too, decay at the same rate α/2.",
        .separating_experiment =
            "Compare the decay of a slow and a fast mode: here both decay at the same rate, with "
            "stiffness-proportional damping the rate grows as the square of the frequency. Or let "
            "the body fall freely",
        .look_alikes = {"stiffness_damping", "drag", "viscoelastic_branch", "elastoplastic_branch",
                        "plane_contact"},
        .conserves_momentum = false,
        .conserves_angular_momentum = false};
    return card;
  }

  explicit MassDampingEffect(const Eigen::VectorXd& parameters) { SetParameters(parameters); }

  const EffectCard& Card() const override { return TheCard(); }
  Eigen::VectorXd Parameters() const override { return Eigen::VectorXd::Constant(1, alpha_); }
  void SetParameters(const Eigen::VectorXd& values) {
    CHECK_EQ(values.size(), 1);
    alpha_ = values[0];
  }

  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    AddDrag(at, alpha_, force);
  }

  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool /*convexify*/,
                   BlockMatrix* tangent) const override {
    for (int i = 0; i < at.body.NodeCount(); ++i) {
      tangent->Block(tangent->pattern().diagonal[i]).diagonal().array() -=
          weights.velocity * alpha_ * at.body.node_mass[i];
    }
  }

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    CHECK_EQ(parameter, 0);
    AddDrag(at, 1, derivative);
  }

 private:
  static void AddDrag(const Kinematics& at, double alpha, Eigen::VectorXd* force) {
    for (int i = 0; i < at.body.NodeCount(); ++i) {
      force->segment<3>(3 * i) -= alpha * at.body.node_mass[i] * at.velocity.segment<3>(3 * i);
    }
  }

  double alpha_ = 0;  // 1/s
};

}  // namespace

const EffectCard& MassDampingCard() { return MassDampingEffect::TheCard(); }

CatalogueEntry MassDamping() {
  return {&MassDampingEffect::TheCard(), CatalogueEntry::Kind::kEffect, &MakeAs<MassDampingEffect>,
          &ReadParameters};
}

}  // namespace lacuna
