// A density that changes linearly along an axis, as where a filler has settled or air has risen:
//   ρ(X) = ρ₀ + ρ′ n·(X − X₀),
// with the body's own density ρ₀. Adds the inertia and the weight of the second term, with the
// volumes around the nodes that the lumped mass uses, so that the total is exact.
#include <glog/logging.h>

#include <limits>

#include "effects/added_mass.h"
#include "effects/rest_region.h"
#include "effects/vector_parameters.h"
#include "fem/cloneable_effect.h"

namespace lacuna {
namespace {

constexpr Dimension kDensityPerLength{-4,           1,       0, 0, 0, "a density per length",
                                      "500 kg/m^4", "kg/m^4"};
constexpr double kMustBeGiven = std::numeric_limits<double>::quiet_NaN();
constexpr double kNoNull = std::numeric_limits<double>::quiet_NaN();

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
                        .default_value = kMustBeGiven}},
        .residual_when_missing =
            "too much weight and inertia at one end and too little at the other, in proportion to "
            "the distance from the origin: sag and frequencies that no single density explains",
        .separating_experiment =
            "balance the body on an edge, which shows its centre of mass; or turn it end for end "
            "in the clamp: a gradient of density changes sign with it, gravity and a soft place "
            "elsewhere do not",
        .look_alikes = {"gravity", "attached_mass"},
        .conserves_momentum = false,
        .conserves_angular_momentum = false};
    AppendVector({.name = "axis",
                  .meaning = "direction in which the density grows, of any length,",
                  .dimension = kDimensionless,
                  .null_value = kNoNull,
                  .plausible_min = -1,
                  .plausible_max = 1,
                  .setting = true},
                 Eigen::Vector3d::UnitZ(), &card);
    AppendVector({.name = "origin",
                  .meaning = "a point at rest where the density is the body's; at the centre of "
                             "volume the total mass stays",
                  .dimension = kLength,
                  .null_value = kNoNull,
                  .plausible_min = -1,
                  .plausible_max = 1,
                  .setting = true},
                 Eigen::Vector3d::Zero(), &card);
    AppendGravitySetting(&card);
    return card;
  }
};

}  // namespace

CatalogueEntry DensityGradient() {
  return {&DensityGradientEffect::TheCard(), CatalogueEntry::Kind::kEffect,
          [](const Eigen::VectorXd& parameters) -> std::shared_ptr<const Effect> {
            return std::make_shared<DensityGradientEffect>(parameters);
          },
          &ReadParameters};
}

}  // namespace lacuna
