#include "effects/gravity.h"

#include <glog/logging.h>

#include "effects/catalogue.h"
#include "effects/vector_parameters.h"
#include "fem/cloneable_effect.h"

namespace lacuna {
namespace {

class GravityEffect final : public CloneableEffect<GravityEffect> {
 public:
  static const EffectCard& TheCard() {
    static const EffectCard card = MakeCard();
    return card;
  }

  explicit GravityEffect(const Eigen::VectorXd& parameters) { SetParameters(parameters); }

  const EffectCard& Card() const override { return TheCard(); }
  Eigen::VectorXd Parameters() const override { return acceleration_; }
  void SetParameters(const Eigen::VectorXd& values) {
    CHECK_EQ(values.size(), 3);
    acceleration_ = values;
  }

  // The lumped masses are those of the inertia, so that a body in free fall stays undeformed.
  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    for (int i = 0; i < at.body.NodeCount(); ++i) {
      force->segment<3>(3 * i) += at.body.node_mass[i] * acceleration_;
    }
  }

  void AddTangents(const Kinematics&, const TangentWeights&, bool, BlockMatrix*) const override {}

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    CHECK(parameter >= 0 && parameter < 3);
    for (int i = 0; i < at.body.NodeCount(); ++i) {
      (*derivative)[3 * i + parameter] += at.body.node_mass[i];
    }
  }

  std::optional<double> Energy(const Kinematics& at) const override {
    return WeightEnergy(at, at.body.node_mass, acceleration_);
  }

 private:
  static EffectCard MakeCard() {
    EffectCard card{
        .type = "gravity",
        .family = EffectFamily::kSteadyForce,
        .title = "Gravity",
        .equation = "f_i = m_i g",
        .citation =
            "I. Newton, Philosophiæ Naturalis Principia Mathematica, 1687; standard value "
            "9.80665 m/s²: 3rd CGPM, 1901",
        .parameters = {},
        .residual_when_missing =
            "The residual is a force field constant in time and proportional to volume: the whole "
            "body sags in one direction, most at its free end. It vanishes to first order if the "
            "rest shape is itself a scan in gravity.",
        .separating_experiment =
            "Turn the fixture upside down and scan again: sag changes sign with gravity, swelling "
            "or a wrong rest shape does not",
        .look_alikes = {"attached_mass", "density_gradient", "point_force", "swelling", "pressure",
                        "plane_contact", "active_contraction"},
        .trial = {.is_in_every_model = true},
        .natural_magnitude = kStandardGravity,
        .conserves_momentum = false,
        .conserves_angular_momentum = false};
    AppendVector({.name = "acceleration",
                  .meaning = "acceleration of free fall",
                  .dimension = kAcceleration,
                  .null_value = 0,
                  .plausible_min = -kStandardGravity,
                  .plausible_max = kStandardGravity},
                 Eigen::Vector3d::Zero(), &card);
    return card;
  }

  Eigen::Vector3d acceleration_;
};

// `acceleration: [0, 0, -9.81 m/s^2]`
Eigen::VectorXd ReadAcceleration(const EffectCard&, const Config& config, const Effect*,
                                 const std::optional<Eigen::Vector3d>&) {
  return config.Vector("acceleration", kAcceleration);
}

}  // namespace

const EffectCard& GravityCard() { return GravityEffect::TheCard(); }
bool IsGravity(const Effect& effect) { return &effect.Card() == &GravityCard(); }

std::shared_ptr<const Effect> MakeGravity(const Eigen::Vector3d& acceleration) {
  return std::make_shared<GravityEffect>(acceleration);
}

std::optional<Eigen::Vector3d> GravityOf(const EffectList& effects) {
  for (const auto& effect : effects)
    if (IsGravity(*effect)) return effect->Parameters().head<3>();
  return std::nullopt;
}

CatalogueEntry Gravity() {
  return {&GravityEffect::TheCard(), CatalogueEntry::Kind::kEffect, &MakeAs<GravityEffect>,
          &ReadAcceleration};
}

}  // namespace lacuna
