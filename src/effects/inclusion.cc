// A stiffer or softer inclusion in the body, with a smooth boundary (extra_stiffness.h).
#include <cmath>

#include "effects/catalogue.h"
#include "effects/extra_stiffness.h"
#include "effects/vector_parameters.h"

namespace lacuna {
namespace {

class BumpWeight {
 public:
  enum Parameter { kDifference, kCentre, kRadius = kCentre + 3 };

  static const EffectCard& Card() {
    static const EffectCard card = MakeCard();
    return card;
  }

  explicit BumpWeight(const Eigen::VectorXd& parameters)
      : centre_(parameters.segment<3>(kCentre)), radius_(parameters[kRadius]) {
    CHECK_GT(radius_, 0);
  }

  double Value(const Eigen::Vector3d& X) const {
    return std::exp(-(X - centre_).squaredNorm() / (2 * radius_ * radius_));
  }

  double Derivative(const Eigen::Vector3d& X, int parameter) const {
    const Eigen::Vector3d arm = X - centre_;
    const double by_log =
        parameter == kRadius ? arm.squaredNorm() / radius_ : arm[parameter - kCentre];
    return Value(X) * by_log / (radius_ * radius_);
  }

 private:
  static EffectCard MakeCard() {
    EffectCard card{
        .type = "inclusion",
        .family = EffectFamily::kStiffnessDistribution,
        .title = "A stiffer or softer inclusion",
        .equation =
            "ψ = w(X) ψ_nH(F; ΔE, ν),  w = exp(−|X − c|²/(2 r²)),  ψ_nH the neo-Hookean energy. "
            "F refers to the rest shape: the lump does not swell with the body (swelling)",
        .citation =
            "J. D. Eshelby, The Determination of the Elastic Field of an Ellipsoidal Inclusion, "
            "and Related Problems, Proc. R. Soc. A 241, 1957, 376–396; smooth lumps in "
            "elastography: A. A. Oberai et al., Inverse Problems 19, 2003, 297–313",
        .parameters = {},
        .residual_when_missing =
            "The surface moves too much on one side of a place inside the body and too little "
            "around it. The residual appears at the same place of the body under every load that "
            "strains it there, in proportion to the strain.",
        .separating_experiment =
            "Change the direction of the load, or press elsewhere: the residual stays at the "
            "inclusion and vanishes under loads that do not strain it. The residual of fibres "
            "follows the direction of the load, that of a grip stays at the grip",
        .look_alikes = {"stiffness_gradient", "fibre_stiffness"},
        .tried_at = TriedAtPlaces{{0.1, 0.25, 0.4, 0.55, 0.7, 0.85}, 0.15},
        .repeatable = true,
        .conserves_momentum = true,
        .conserves_angular_momentum = true};
    card.parameters.push_back(YoungModulusDifference("at the centre of the lump"));
    AppendVector({.name = "centre",
                  .meaning = "place of the lump in the rest shape,",
                  .dimension = kLength,
                  .null_value = kNoNullValue,
                  .plausible_min = -0.2,
                  .plausible_max = 0.2,
                  .of_body = true},
                 Eigen::Vector3d::Constant(kMustBeGiven), &card);
    card.parameters.push_back({.name = "radius",
                               .meaning = "distance from the centre at which 61 % of the "
                                          "difference is left, r; some element sizes at least",
                               .dimension = kLength,
                               .bounds = kPositive,
                               .null_value = kNoNullValue,
                               .plausible_min = 0.002,
                               .plausible_max = 0.05,
                               .of_body = true,
                               .default_value = kMustBeGiven,
                               .log_scale = true,
                               .trial = {.share_of_length = 0.15}});
    card.parameters.push_back(PoissonRatioSetting());
    return card;
  }

  Eigen::Vector3d centre_;  // m
  double radius_;           // m
};

}  // namespace

CatalogueEntry Inclusion() {
  return {&BumpWeight::Card(), CatalogueEntry::Kind::kEffect,
          &MakeAs<PointEnergyEffect<ExtraStiffnessLaw<BumpWeight>>>, &ReadParameters};
}

}  // namespace lacuna
