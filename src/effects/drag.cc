// Resistance of the surrounding medium, such as air or water, to the motion of the body's surface.
//
// |v| v and its derivative |v| I + v vᵀ/|v| are continuous at v = 0, where both vanish, and the
// derivative is positive semi-definite: no smoothing is needed and the exact tangent is definite.
// The law neglects the wake and the added mass of the medium; the shape enters through c only.
#include <glog/logging.h>

#include "effects/catalogue.h"
#include "effects/rest_quantity.h"
#include "fem/cloneable_effect.h"

namespace lacuna {
namespace {

constexpr Dimension kLinearResistance{-2,          1,       -1, 0, 0, "a pressure per velocity",
                                      "10 Pa s/m", "Pa s/m"};

class DragEffect final : public CloneableEffect<DragEffect> {
 public:
  enum Parameter { kCoefficient, kLinear };
  static constexpr int kParameters = kLinear + 1;

  static const EffectCard& TheCard() {
    static const EffectCard card{
        .type = "drag",
        .family = EffectFamily::kLossOutside,
        .title = "Drag of the surrounding medium",
        .equation = "f_i = −A_i (b |v_i| + d) v_i,  b = ½ c ρ_medium",
        .citation =
            "I. Newton, Philosophiæ Naturalis Principia Mathematica, 1687, book II (resistance as "
            "the square of the velocity); G. G. Stokes, Trans. Camb. Phil. Soc. 9 (1851) (as the "
            "velocity); S. F. Hoerner, Fluid-Dynamic Drag, 1965 (coefficients)",
        .parameters =
            {{.name = "coefficient",
              .meaning = "b = ½ c ρ_medium with c per wetted area, a quarter of the usual "
                         "coefficient per frontal area for a sphere; some 0.2 kg/m³ in air, "
                         "150 kg/m³ in water",
              .dimension = kDensity,
              .bounds = kNotNegative,
              .null_value = 0,
              .plausible_min = 0,
              .plausible_max = 300,
              .default_value = kMustBeGiven,
              .log_scale = false},
             {.name = "linear",
              .meaning =
                  "d, resistance per area that grows as the velocity, as in a viscous medium",
              .dimension = kLinearResistance,
              .bounds = kNotNegative,
              .null_value = 0,
              .plausible_min = 0,
              .plausible_max = 100,
              .default_value = 0,
              .log_scale = false}},
        .residual_when_missing =
            "The residual is a force against the velocity, on the surface only, which quadruples "
            "when the velocity doubles: large oscillations decay faster than predicted, small ones "
            "do not.",
        .separating_experiment =
            "Let the body oscillate from a large and from a small amplitude: under drag the decay "
            "rate grows in proportion to the amplitude, with damping linear in the velocity it "
            "does not. Or repeat the motion in another medium",
        .look_alikes = {"mass_damping", "stiffness_damping"},
        .conserves_momentum = false,
        .conserves_angular_momentum = false};
    return card;
  }

  explicit DragEffect(const Eigen::VectorXd& parameters) { SetParameters(parameters); }

  const EffectCard& Card() const override { return TheCard(); }
  Eigen::VectorXd Parameters() const override { return parameters_; }
  void SetParameters(const Eigen::VectorXd& values) {
    CHECK_EQ(values.size(), kParameters);
    parameters_ = values;
  }

  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    ForEachBoundaryNode(at, [&](int node, double area, const Eigen::Vector3d& velocity) {
      const double resistance = parameters_[kCoefficient] * velocity.norm() + parameters_[kLinear];
      force->segment<3>(3 * node) -= area * resistance * velocity;
    });
  }

  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool /*convexify*/,
                   BlockMatrix* tangent) const override {
    ForEachBoundaryNode(at, [&](int node, double area, const Eigen::Vector3d& velocity) {
      const double speed = velocity.norm();
      const double b = parameters_[kCoefficient];
      Eigen::Matrix3d slope = (b * speed + parameters_[kLinear]) * Eigen::Matrix3d::Identity();
      if (speed > 0) slope += b / speed * velocity * velocity.transpose();
      tangent->Block(tangent->pattern().diagonal[node]) -= weights.velocity * area * slope;
    });
  }

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    CHECK(parameter >= 0 && parameter < kParameters);
    ForEachBoundaryNode(at, [&](int node, double area, const Eigen::Vector3d& velocity) {
      derivative->segment<3>(3 * node) -=
          area * (parameter == kCoefficient ? velocity.norm() : 1.0) * velocity;
    });
  }

 private:
  template <typename Visit>
  void ForEachBoundaryNode(const Kinematics& at, const Visit& visit) const {
    const Eigen::VectorXi& nodes = at.body.boundary.node;
    const auto areas = areas_.Of(
        at.body, [](const Body& body, const Eigen::VectorXd&) { return NodeBoundaryAreas(body); });
    for (const int node : nodes) visit(node, (*areas)[node], at.velocity.segment<3>(3 * node));
  }

  Eigen::VectorXd parameters_;           // in the order of the card
  RestQuantity<Eigen::VectorXd> areas_;  // n, m²
};

}  // namespace

CatalogueEntry Drag() {
  return {&DragEffect::TheCard(), CatalogueEntry::Kind::kEffect, &MakeAs<DragEffect>,
          &ReadParameters};
}

}  // namespace lacuna
