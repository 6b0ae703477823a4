// A density that changes linearly along an axis, for example because a filler has settled:
//   ρ(X) = ρ₀ + ρ′ n·(X − X₀),
// with the density ρ₀ of the body. The effect adds the inertia and the weight of the second term.
// It uses the nodal volumes of the lumped mass, so that the total mass is exact.
#include <glog/logging.h>

#include "effects/added_mass.h"
#include "effects/catalogue.h"
#include "effects/gravity.h"
#include "effects/rest_region.h"
#include "effects/vector_parameters.h"
#include "fem/cloneable_effect.h"

namespace lacuna {
namespace {

constexpr Dimension kDensityPerLength{-4,           1,       0, 0, 0, "a density per length",
                                      "500 kg/m^4", "kg/m^4"};

class DensityGradientEffect final : public CloneableEffect<DensityGradientEffect, AddedMass> {
 public:
  enum Parameter { kGradient, kAxis, kOrigin = kAxis + 3 };

  static const EffectCard& TheCard() {
    static const EffectCard card = MakeCard();
    return card;
  }

  explicit DensityGradientEffect(const Eigen::VectorXd& parameters) { SetParameters(parameters); }

  const EffectCard& Card() const override { return TheCard(); }
  void SetParameters(const Eigen::VectorXd& values) {
    AddedMass::SetParameters(values);
    CHECK_GT(values.segment<3>(kAxis).norm(), 0) << "a gradient needs an axis";
  }

 private:
  Eigen::VectorXd MassPerUnit(const Body& body) const override {
    const Eigen::Vector3d axis = parameters_.segment<3>(kAxis).normalized();
    const Eigen::Vector3d origin = parameters_.segment<3>(kOrigin);
    const Eigen::VectorXd height = (body.mesh.nodes.colwise() - origin).transpose() * axis;
    return NodeVolumes(body).cwiseProduct(height);
  }

  static EffectCard MakeCard() {
    EffectCard card{
        .type = "density_gradient",
        .family = EffectFamily::kMassDistribution,
        .title = "Density that varies along an axis",
        .equation = "f_i = ρ′ n·(X_i − X₀) V_i (g − a_i)",
        .citation =
            "E. Hinton, T. Rock & O. C. Zienkiewicz, A note on mass lumping and related processes "
            "in the finite element method, Earthquake Eng. Struct. Dyn. 4 (1976) 245–249 (the "
            "volumes V_i)",
        .parameters = {{.name = "gradient",
                        .meaning = "growth of the density per length along the axis, ρ′",
                        .dimension = kDensityPerLength,
                        .bounds = kAnyValue,
                        .null_value = 0,
                        .plausible_min = -2000,
                        .plausible_max = 2000,
                        .of_body = true,
                        .default_value = kMustBeGiven}},
        .residual_when_missing =
            "Weight and inertia are too large at one end and too small at the other, in proportion "
            "to the distance from the origin: no single density explains both the sag and the "
            "frequencies.",
        .separating_experiment =
            "Balance the body on an edge, which shows its centre of mass; or turn it end for end "
            "in the clamp: the residual of a density gradient changes sign, that of gravity or of "
            "a soft place elsewhere does not",
        .look_alikes = {"gravity", "attached_mass"},
        .tried_at = TriedAsGradients{},
        .trial = {.axis_along_bar = true},
        .conserves_momentum = false,
        .conserves_angular_momentum = false};
    AppendDirectionSetting("axis", "direction in which the density grows, of any length,",
                           Eigen::Vector3d::UnitZ(), &card);
    AppendPointSetting("origin",
                       "a point at rest where the density is the body's; at the centre of volume "
                       "the total mass stays",
                       &card);
    AppendGravitySetting(&card);
    return card;
  }
};

}  // namespace

CatalogueEntry DensityGradient() {
  return {&DensityGradientEffect::TheCard(), CatalogueEntry::Kind::kEffect,
          &MakeAs<DensityGradientEffect>, &ReadParameters};
}

}  // namespace lacuna
