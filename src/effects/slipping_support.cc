// A support that slips: an elastic bed whose springs slide once their stretch reaches a limit,
//   f_i = −k w_i A_i e_i,  e_i = u_i − s_i,  ‖e_i‖ ≤ d,  s_i flows along e_i at the limit only,
// with the displacement u_i = x_i − X_i and the slip s_i of each boundary node: an isotropic Jenkin
// element in three dimensions. It models a clamp, a glued pad or a sleeve in which the body begins
// to slide; under a clamping pressure p with the coefficient of friction μ, k d = μ p. The limit is
// a distance so that the slip does not depend on k: a support with k = 0 slips as one with any k
// would, and the derivative with respect to k at 0 exists. Nodes that a grip holds are not
// affected. A support that the body may leave is a contact (plane_contact.cc).
//
// The slip at the end of a step follows from a radial return (radial_return.h), whose incremental
// potential is convex: quadratic up to the limit and linear beyond it.
#include <glog/logging.h>

#include "effects/bedding.h"
#include "effects/catalogue.h"
#include "effects/radial_return.h"
#include "fem/cloneable_effect.h"

namespace lacuna {
namespace {

class SlippingSupportEffect final : public CloneableEffect<SlippingSupportEffect> {
 public:
  enum Parameter { kModulus, kSlipDistance, kPart };

  static const EffectCard& TheCard() {
    static const EffectCard card = MakeCard();
    return card;
  }

  explicit SlippingSupportEffect(const Eigen::VectorXd& parameters) { SetParameters(parameters); }

  const EffectCard& Card() const override { return TheCard(); }
  Eigen::VectorXd Parameters() const override { return parameters_; }
  void SetParameters(const Eigen::VectorXd& values) {
    CHECK_EQ(values.size(), static_cast<Eigen::Index>(TheCard().parameters.size()));
    parameters_ = values;
    part_.SetParameters(values);
  }

  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    ForEachSpring(at, [&](int node, double area, const Eigen::Vector3d& stretch) {
      force->segment<3>(3 * node) -= Modulus() * area * Held(stretch);
    });
  }

  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool /*convexify*/,
                   BlockMatrix* tangent) const override {
    ForEachSpring(at, [&](int node, double area, const Eigen::Vector3d& stretch) {
      tangent->Block(tangent->pattern().diagonal[node]) -=
          weights.position * Modulus() * area * HeldDerivative(stretch);
    });
  }

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    if (parameter >= kPart) {
      const Eigen::VectorXd area_derivatives =
          part_.AreaDerivatives(at.body, TheCard().type, parameter - kPart);
      ForEachSpring(at, [&](int node, double, const Eigen::Vector3d& stretch) {
        derivative->segment<3>(3 * node) -= Modulus() * area_derivatives[node] * Held(stretch);
      });
      return;
    }
    ForEachSpring(at, [&](int node, double area, const Eigen::Vector3d& stretch) {
      if (parameter == kModulus)
        derivative->segment<3>(3 * node) -= area * Held(stretch);
      else
        derivative->segment<3>(3 * node) -= Modulus() * area * HeldDistanceDerivative(stretch);
    });
  }

  std::optional<double> Energy(const Kinematics& at) const override {
    double energy = 0;
    const double limit = SlipDistance();
    ForEachSpring(at, [&](int, double area, const Eigen::Vector3d& stretch) {
      const double length = stretch.norm();
      energy += Modulus() * area *
                (length <= limit ? 0.5 * length * length : limit * (length - 0.5 * limit));
    });
    return energy;
  }

  // s_i, m.
  Eigen::Index StateSize(const Body& body) const override { return 3 * body.NodeCount(); }
  void InitialState(const Body& body, Eigen::VectorXd* state) const override {
    *state = Eigen::VectorXd::Zero(StateSize(body));
  }
  void AdvanceState(const Kinematics& at, Eigen::VectorXd* state_at_end) const override {
    CHECK_EQ(state_at_end->size(), StateSize(at.body));
    *state_at_end = at.state;
    ForEachSpring(at, [&](int node, double, const Eigen::Vector3d& stretch) {
      state_at_end->segment<3>(3 * node) += stretch - Held(stretch);
    });
  }

  void AddStateDerivatives(const Kinematics& at, const Eigen::Ref<const Eigen::MatrixXd>& changes,
                           Eigen::Ref<Eigen::MatrixXd> forces) const override {
    ForEachSpring(at, [&](int node, double area, const Eigen::Vector3d& stretch) {
      forces.middleRows<3>(3 * node) +=
          Modulus() * area * HeldDerivative(stretch) * changes.middleRows<3>(3 * node);
    });
  }
  void AdvanceStateDerivatives(const Kinematics& at, const Eigen::Ref<const Eigen::MatrixXd>& moved,
                               Eigen::Ref<Eigen::MatrixXd> changes) const override {
    ForEachSpring(at, [&](int node, double, const Eigen::Vector3d& stretch) {
      const Eigen::Matrix3d slides = Eigen::Matrix3d::Identity() - HeldDerivative(stretch);
      changes.middleRows<3>(3 * node) +=
          slides * (moved.middleRows<3>(3 * node) - changes.middleRows<3>(3 * node));
    });
  }
  // The part that the support holds weighs its springs, and does not change where they slide.
  void AddStateByParameter(const Kinematics& at, int parameter,
                           Eigen::Ref<Eigen::VectorXd> change) const override {
    if (parameter != kSlipDistance) return;
    ForEachSpring(at, [&](int node, double, const Eigen::Vector3d& stretch) {
      change.segment<3>(3 * node) -= HeldDistanceDerivative(stretch);
    });
  }

 private:
  static EffectCard MakeCard() {
    EffectCard card{
        .type = "slipping_support",
        .family = EffectFamily::kLossOutside,
        .title = "Support that slips",
        .equation =
            "f_i = −k w_i A_i (u_i − s_i),  ‖u_i − s_i‖ ≤ d,  s_i flows along u_i − s_i at the "
            "limit only,  u_i = x_i − X_i,  w_i = exp(−|X_i − c|²/(2 r²)) or 1,  A_i of the whole "
            "surface or of one side",
        .citation =
            "E. Winkler, Die Lehre von der Elasticität und Festigkeit, Prag 1867 (the bed); G. "
            "Masing, Eigenspannungen und Verfestigung beim Messing, 1926 (elements that slide); "
            "R. D. Mindlin, Compliance of Elastic Bodies in Contact, Journal of Applied Mechanics "
            "16, 1949 (partial slip)",
        .parameters = {BeddingModulus(),
                       {.name = "slip_distance",
                        .meaning =
                            "displacement at which a place of the support starts to slide, d; the "
                            "largest traction is k d",
                        .dimension = kLength,
                        .bounds = kPositive,
                        .null_value = kNoNullValue,
                        .plausible_min = 1e-5,
                        .plausible_max = 1e-2,
                        .of_body = true,
                        .default_value = kMustBeGiven,
                        .log_scale = true,
                        .trial = {.min = 2e-4, .max = 2e-3, .draw = 9}}},
        .residual_when_missing =
            "One part of the surface is held at small displacements, then slides and does not "
            "return: the residual after each large motion persists until the next one.",
        .separating_experiment =
            "Load gently, then hard, and look at the support at rest in between: a slip persists "
            "and is visible at the support itself. A yielding support or a softer body returns, "
            "and a permanent set of the material is largest where the strain was largest",
        .look_alikes = {"elastic_support", "elastoplastic_branch", "plane_contact"},
        .tried_at = TriedAsSupports{.slip_shares = {0.002, 0.02}},
        .repeatable = true,
        .conserves_momentum = false,
        .conserves_angular_momentum = false};
    AppendBeddedPart(&card);
    return card;
  }

  double Modulus() const { return parameters_[kModulus]; }
  double SlipDistance() const { return parameters_[kSlipDistance]; }

  // The stretch that the spring keeps, with its derivatives with respect to the stretch and to d.
  Eigen::Vector3d Held(const Eigen::Vector3d& stretch) const {
    return RadialReturn(stretch, SlipDistance());
  }
  Eigen::Matrix3d HeldDerivative(const Eigen::Vector3d& stretch) const {
    return RadialReturnDerivative(stretch, SlipDistance());
  }
  Eigen::Vector3d HeldDistanceDerivative(const Eigen::Vector3d& stretch) const {
    return stretch.norm() <= SlipDistance() ? Eigen::Vector3d(0, 0, 0) : stretch.normalized();
  }

  // Calls visit(node, w_i A_i, x_i − X_i − s_i) with the slip at the start of the step.
  template <typename Visit>
  void ForEachSpring(const Kinematics& at, const Visit& visit) const {
    CHECK_EQ(at.state.size(), StateSize(at.body));
    const auto areas = part_.Areas(at.body, TheCard().type);
    for (const int node : at.body.boundary.node) {
      const Eigen::Vector3d stretch = at.position.segment<3>(3 * node) -
                                      at.body.mesh.nodes.col(node) - at.state.segment<3>(3 * node);
      visit(node, (*areas)[node], stretch);
    }
  }

  Eigen::VectorXd parameters_;  // in the order of the card
  BeddedPart part_;
};

}  // namespace

CatalogueEntry SlippingSupport() {
  return {&SlippingSupportEffect::TheCard(), CatalogueEntry::Kind::kEffect,
          &MakeAs<SlippingSupportEffect>, &ReadParameters};
}

}  // namespace lacuna
