// Uniform gravity, or any other uniform acceleration of the laboratory.
#include <glog/logging.h>

#include "effects/catalogue.h"
#include "fem/cloneable_effect.h"

namespace lacuna {
namespace {

constexpr double kStandardGravity = 9.80665;  // m/s²

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

  // With the lumped masses that inertia uses, so that a body in free fall stays undeformed.
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

  // Zero at the rest shape, which keeps the digits where they are needed.
  std::optional<double> Energy(const Kinematics& at) const override {
    double energy = 0;
    for (int i = 0; i < at.body.NodeCount(); ++i) {
      energy -= at.body.node_mass[i] *
                acceleration_.dot(at.position.segment<3>(3 * i) - at.body.mesh.nodes.col(i));
    }
    return energy;
  }

 private:
  static EffectCard MakeCard() {
    EffectCard card{
        .type = "gravity",
        .title = "Gravity",
        .equation = "f_i = m_i g",
        .citation =
            "I. Newton, Philosophiæ Naturalis Principia Mathematica, 1687; standard value "
            "9.80665 m/s²: 3rd CGPM, 1901",
        .parameters = {},
        .residual_when_missing =
            "a force field constant in time and proportional to volume; the whole body sags one "
            "way, most at its free end. It vanishes to first order if the rest shape is itself a "
            "scan in gravity",
        .separating_experiment =
            "turn the fixture upside down and scan again: sag changes sign "
            "with gravity, swelling or a wrong rest shape does not",
        .look_alikes = {"attached_mass", "density_gradient", "point_force", "swelling", "pressure",
                        "plane_contact", "active_contraction"},
        .conserves_momentum = false,
        .conserves_angular_momentum = false};
    for (const char* axis : {"x", "y", "z"}) {
      card.parameters.push_back({.name = std::string("acceleration_") + axis,
                                 .meaning = std::string("acceleration of free fall along ") + axis,
                                 .dimension = kAcceleration,
                                 .bounds = kAnyValue,
                                 .null_value = 0,
                                 .plausible_min = -kStandardGravity,
                                 .plausible_max = kStandardGravity,
                                 .default_value = 0,
                                 .log_scale = false});
    }
    return card;
  }

  Eigen::Vector3d acceleration_;
};

// `acceleration: [0, 0, -9.81 m/s^2]`
Eigen::VectorXd ReadAcceleration(const EffectCard&, const Config& config, const Effect*) {
  return config.Vector("acceleration", kAcceleration);
}

}  // namespace

CatalogueEntry Gravity() {
  return {&GravityEffect::TheCard(), CatalogueEntry::Kind::kEffect, &MakeAs<GravityEffect>,
          &ReadAcceleration};
}

}  // namespace lacuna
