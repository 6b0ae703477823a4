// A constant force on a small part of the surface during an interval of time, such as that of a
// hand, a string or a weight.
//
// The force is distributed over the boundary nodes around the place c at rest as
// exp(−|X − c|²/(2 r²)) times the area around each node. It keeps its direction in space. In a step
// with inertia from t − h to t it acts with the share of the step that lies between `start` and
// `stop`, so that its impulse is F (stop − start) for any time steps. An equilibrium at t, also one
// at the end of a quasi-static step, has the whole force if start ≤ t < stop.
#include <glog/logging.h>

#include <algorithm>

#include "effects/catalogue.h"
#include "effects/rest_quantity.h"
#include "effects/rest_region.h"
#include "effects/vector_parameters.h"
#include "fem/cloneable_effect.h"

namespace lacuna {
namespace {

// s: before and after every recording, also one whose clock counts from 1970.
constexpr double kAlways = 1e12;

class PointForceEffect final : public CloneableEffect<PointForceEffect> {
 public:
  enum Parameter { kForceValue, kCentre = kForceValue + 3, kRadius = kCentre + 3, kStart, kStop };
  static constexpr int kParameters = kStop + 1;

  static const EffectCard& TheCard() {
    static const EffectCard card = MakeCard();
    return card;
  }

  explicit PointForceEffect(const Eigen::VectorXd& parameters) { SetParameters(parameters); }

  const EffectCard& Card() const override { return TheCard(); }
  Eigen::VectorXd Parameters() const override { return parameters_; }
  void SetParameters(const Eigen::VectorXd& values) {
    CHECK_EQ(values.size(), kParameters);
    parameters_ = values;
    shares_.SetSettings(values.segment<4>(kCentre));
  }

  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    AddShares(at, *Shares(at.body), parameters_.head<3>(), force);
  }

  void AddTangents(const Kinematics&, const TangentWeights&, bool, BlockMatrix*) const override {}

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    CHECK(parameter >= 0 && parameter < kRadius) << "the others are settings";
    const auto shares = Shares(at.body);
    if (parameter < kCentre) {
      AddShares(at, *shares, Eigen::Vector3d::Unit(parameter), derivative);
    } else {
      AddShares(at,
                BumpShareDerivatives(parameter - kCentre, parameters_[kRadius], at.body.mesh.nodes,
                                     *shares),
                parameters_.head<3>(), derivative);
    }
  }

  std::optional<double> Energy(const Kinematics& at) const override {
    const auto shares = Shares(at.body);
    const auto displacement = at.position.reshaped(3, shares->size()) - at.body.mesh.nodes;
    return -PresentShare(at) * parameters_.head<3>().dot(displacement * *shares);
  }

 private:
  static EffectCard MakeCard() {
    EffectCard card{
        .type = "point_force",
        .family = EffectFamily::kSteadyForce,
        .title = "Force on a place of the surface",
        .equation =
            "f_i = F s_i for start ≤ t < stop,  s_i ∝ A_i exp(−|X_i − c|²/(2 r²)),  Σ s_i = 1",
        .citation =
            "I. Newton, Philosophiæ Naturalis Principia Mathematica, 1687; A. J. C. Barré de "
            "Saint-Venant, Mém. Savants Étrangers 14 (1855) (why the spread does not matter far "
            "away)",
        .parameters = {},
        .residual_when_missing =
            "The residual is a force at one place, constant in magnitude and direction from one "
            "moment to another, without a counterpart in any other force.",
        .separating_experiment =
            "Shake the body: a constant force stays the same, an attached mass also pulls against "
            "the acceleration. Turn the fixture: a force that keeps its direction in space is not "
            "fixed to the fixture",
        .look_alikes = {"gravity", "attached_mass", "follower_force"},
        .tried_at = TriedAtPlaces{{0.05, 0.2, 0.35, 0.5, 0.65, 0.8, 0.95}, 0.1},
        .repeatable = true,
        .conserves_momentum = false,
        .conserves_angular_momentum = false};
    AppendVector({.name = "force",
                  .meaning = "the force, F,",
                  .dimension = kForce,
                  .null_value = 0,
                  .plausible_min = -5,
                  .plausible_max = 5,
                  .of_body = true},
                 Eigen::Vector3d::Constant(kMustBeGiven), &card);
    AppendPlace("the place on the body at rest where it acts,", &card);
    card.parameters.push_back({.name = "start",
                               .meaning = "time from which it acts (by default always)",
                               .dimension = kTime,
                               .null_value = kNoNullValue,
                               .plausible_min = 0,
                               .plausible_max = 1e3,
                               .default_value = -kAlways,
                               .setting = true});
    card.parameters.push_back({.name = "stop",
                               .meaning = "time from which it acts no longer (by default never)",
                               .dimension = kTime,
                               .null_value = kNoNullValue,
                               .plausible_min = 0,
                               .plausible_max = 1e3,
                               .default_value = kAlways,
                               .setting = true});
    return card;
  }

  std::shared_ptr<const Eigen::VectorXd> Shares(const Body& body) const {
    return shares_.Of(body, [](const Body& at_rest, const Eigen::VectorXd& place) {
      return BumpShares(place.head<3>(), place[3], at_rest.mesh.nodes, NodeBoundaryAreas(at_rest));
    });
  }

  // The share of the force that acts: of a step with inertia, the part between start and stop.
  double PresentShare(const Kinematics& at) const {
    const double start = parameters_[kStart], stop = parameters_[kStop];
    if (!at.has_inertia) {
      // The end of a step may lie before `start` or `stop` by rounding.
      constexpr double kRounding = 1e-6;
      const double now = at.time + kRounding * at.time_step;
      return start <= now && now < stop ? 1 : 0;
    }
    const double from = std::max(start, at.time - at.time_step);
    return std::clamp((std::min(stop, at.time) - from) / at.time_step, 0.0, 1.0);
  }

  void AddShares(const Kinematics& at, const Eigen::VectorXd& shares, const Eigen::Vector3d& total,
                 Eigen::VectorXd* force) const {
    force->reshaped(3, shares.size()) += PresentShare(at) * total * shares.transpose();
  }

  Eigen::VectorXd parameters_;  // in the order of the card
  RestQuantity<Eigen::VectorXd> shares_;
};

Eigen::VectorXd ReadPointForce(const EffectCard& card, const Config& config, const Effect* material,
                               const std::optional<Eigen::Vector3d>& gravity) {
  const Eigen::VectorXd values = ReadParameters(card, config, material, gravity);
  if (values[PointForceEffect::kStop] <= values[PointForceEffect::kStart]) {
    config.Fail("stop", "expected a time after start");
  }
  return values;
}

}  // namespace

CatalogueEntry PointForce() {
  return {&PointForceEffect::TheCard(), CatalogueEntry::Kind::kEffect, &MakeAs<PointForceEffect>,
          &ReadPointForce};
}

}  // namespace lacuna
