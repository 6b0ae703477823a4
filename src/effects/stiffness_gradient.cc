// A stiffness that changes linearly along a direction of the body, as in a casting that cured or
// settled unevenly (extra_stiffness.h).

#include "effects/catalogue.h"
#include "effects/extra_stiffness.h"
#include "effects/vector_parameters.h"

namespace lacuna {
namespace {

class LinearWeight {
 public:
  enum Parameter { kDifference, kOrigin, kAxis = kOrigin + 3, kLengthScale = kAxis + 3 };

  static const EffectCard& Card() {
    static const EffectCard card = MakeCard();
    return card;
  }

  explicit LinearWeight(const Eigen::VectorXd& parameters)
      : origin_(parameters.segment<3>(kOrigin)),
        gradient_(parameters.segment<3>(kAxis).normalized() / parameters[kLengthScale]) {
    CHECK_GT(parameters.segment<3>(kAxis).norm(), 0) << "a gradient needs a direction";
    CHECK_GT(parameters[kLengthScale], 0);
  }

  double Value(const Eigen::Vector3d& X) const { return gradient_.dot(X - origin_); }

 private:
  static EffectCard MakeCard() {
    EffectCard card{
        .type = "stiffness_gradient",
        .family = EffectFamily::kStiffnessDistribution,
        .title = "Stiffness that changes along the body",
        .equation =
            "ψ = w(X) ψ_nH(F; ΔE, ν),  w = a·(X − o)/L with |a| = 1,  ψ_nH the neo-Hookean "
            "energy. F refers to the rest shape: what is added does not swell with the body "
            "(swelling)",
        .citation =
            "S. Suresh, A. Mortensen, Fundamentals of Functionally Graded Materials, IOM "
            "Communications 1998; neo-Hookean energy: B. Smith, F. de Goes, T. Kim, ACM TOG 37(2), "
            "2018, Eq. 13",
        .parameters = {},
        .residual_when_missing =
            "Strain is predicted too small towards one end of the body and too large towards the "
            "other, in proportion to the load and for any direction of the load.",
        .separating_experiment =
            "Hold the body at its other end and load it again: the soft end stays soft, whereas an "
            "error of the grip or of the load moves to the other end with the grip",
        .look_alikes = {"inclusion", "fibre_stiffness"},
        .tried_at = TriedAsGradients{},
        .trial = {.axis_along_bar = true},
        .conserves_momentum = true,
        .conserves_angular_momentum = true};
    card.parameters.push_back(YoungModulusDifference("over the length L, evenly along a"));
    AppendVector({.name = "origin",
                  .meaning = "place in the rest shape where nothing is added, o,",
                  .dimension = kLength,
                  .null_value = kNoNullValue,
                  .plausible_min = -0.2,
                  .plausible_max = 0.2,
                  .setting = true},
                 Eigen::Vector3d::Zero(), &card);
    AppendDirectionSetting("axis", "direction in which stiffness grows, of any length,",
                           Eigen::Vector3d::Constant(kMustBeGiven), &card);
    card.parameters.push_back({.name = "length",
                               .meaning = "distance over which the difference is added, L",
                               .dimension = kLength,
                               .bounds = kPositive,
                               .null_value = kNoNullValue,
                               .plausible_min = 0.01,
                               .plausible_max = 1,
                               .of_body = true,
                               .default_value = 0.1,
                               .setting = true,
                               .trial = {.share_of_length = 1}});
    card.parameters.push_back(PoissonRatioSetting());
    return card;
  }

  Eigen::Vector3d origin_;    // m
  Eigen::Vector3d gradient_;  // a/L, 1/m
};

}  // namespace

CatalogueEntry StiffnessGradient() {
  return {&LinearWeight::Card(), CatalogueEntry::Kind::kEffect,
          &MakeAs<PointEnergyEffect<ExtraStiffnessLaw<LinearWeight>>>, &ReadParameters};
}

}  // namespace lacuna
