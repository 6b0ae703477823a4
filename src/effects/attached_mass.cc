// The inertia and weight of a small mass on or in the body, such as a marker, a sensor or a bolt.
//
// The mass is distributed over the nodes around its place c at rest as exp(−|X − c|²/(2 r²)) times
// the volume around each node, so that the result converges as the mesh is refined. With r well
// below the element size the mass falls on the nearest nodes, and its place is only resolved to the
// element size. It adds no stiffness and no rotational inertia beyond that of the nodes.
#include "effects/attached_mass.h"

#include <glog/logging.h>

#include "effects/added_mass.h"
#include "effects/catalogue.h"
#include "effects/gravity.h"
#include "effects/rest_region.h"
#include "effects/vector_parameters.h"
#include "fem/cloneable_effect.h"

namespace lacuna {
namespace {

class AttachedMassEffect final : public CloneableEffect<AttachedMassEffect, AddedMass> {
 public:
  enum Parameter { kAddedMass, kCentre, kRadius = kCentre + 3 };

  static const EffectCard& TheCard() {
    static const EffectCard card = MakeCard();
    return card;
  }

  explicit AttachedMassEffect(const Eigen::VectorXd& parameters) { SetParameters(parameters); }

  const EffectCard& Card() const override { return TheCard(); }

 private:
  Eigen::VectorXd MassPerUnit(const Body& body) const override {
    return BumpShares(parameters_.segment<3>(kCentre), parameters_[kRadius], body.mesh.nodes,
                      NodeVolumes(body));
  }

  Eigen::VectorXd MassPerUnitDerivative(const Body& body, int parameter,
                                        const Eigen::VectorXd& mass) const override {
    CHECK(parameter >= kCentre && parameter < kRadius) << "the others are settings";
    return BumpShareDerivatives(parameter - kCentre, parameters_[kRadius], body.mesh.nodes, mass);
  }

  static EffectCard MakeCard() {
    EffectCard card{
        .type = "attached_mass",
        .family = EffectFamily::kMassDistribution,
        .title = "Attached mass",
        .equation = "f_i = m s_i (g − a_i),  s_i ∝ V_i exp(−|X_i − c|²/(2 r²)),  Σ s_i = 1",
        .citation =
            "I. Newton, Philosophiæ Naturalis Principia Mathematica, 1687 (second law); S. P. "
            "Timoshenko, D. H. Young & W. Weaver, Vibration Problems in Engineering, 4th ed., "
            "Wiley 1974 (bars and beams that carry a mass)",
        .parameters = {{.name = "mass",
                        .meaning = "mass added, m; negative where mass is missing, as in a void",
                        .dimension = kMass,
                        .bounds = kAnyValue,
                        .null_value = 0,
                        .plausible_min = -0.02,
                        .plausible_max = 0.05,
                        .of_body = true,
                        .default_value = kMustBeGiven}},
        .residual_when_missing =
            "The residual is a force at one place, m g at rest and m (g − a) in motion with the "
            "local acceleration a. All modes that move this place are slower than predicted, modes "
            "with a node there are not.",
        .separating_experiment =
            "Hold still, then shake: a point force stays the same, a mass also pulls against the "
            "acceleration. Turn the fixture: the weight of the mass rotates relative to the body",
        .look_alikes = {"gravity", "density_gradient", "point_force"},
        .tried_at = TriedAtPlaces{{0.05, 0.2, 0.35, 0.5, 0.65, 0.8, 0.95}, 0.05},
        .repeatable = true,
        .conserves_momentum = false,
        .conserves_angular_momentum = false};
    AppendPlace("place of the mass on the body at rest", &card);
    AppendGravitySetting(&card);
    return card;
  }
};

}  // namespace

std::shared_ptr<const Effect> MakeAttachedMass(double mass, const Eigen::Vector3d& place,
                                               double radius, const Eigen::Vector3d& gravity) {
  Eigen::VectorXd parameters(8);
  parameters << mass, place, radius, gravity;
  return std::make_shared<AttachedMassEffect>(parameters);
}

CatalogueEntry AttachedMass() {
  return {&AttachedMassEffect::TheCard(), CatalogueEntry::Kind::kEffect,
          &MakeAs<AttachedMassEffect>, &ReadParameters};
}

}  // namespace lacuna
