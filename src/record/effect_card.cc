#include "record/effect_card.h"

#include "core/error.h"

namespace lacuna {
namespace {

struct Family {
  EffectFamily family;
  const char *name, *title;
};

constexpr Family kFamilies[] = {
    {EffectFamily::kOther, "other", "other physics"},
    {EffectFamily::kSteadyForce, "steady_force", "steady force"},
    {EffectFamily::kLossOutside, "loss_outside", "loss outside the body"},
    {EffectFamily::kLossInside, "loss_inside", "loss inside the body"},
    {EffectFamily::kVolumeStress, "volume_stress", "stress without a load"},
    {EffectFamily::kStiffnessDistribution, "stiffness_distribution", "distribution of stiffness"},
    {EffectFamily::kMassDistribution, "mass_distribution", "distribution of mass"},
    {EffectFamily::kElasticity, "elasticity", "elasticity at large strain"},
    {EffectFamily::kContact, "contact", "contact"},
};

const Family& Find(EffectFamily family) {
  for (const Family& entry : kFamilies)
    if (entry.family == family) return entry;
  return kFamilies[0];
}

}  // namespace

ParameterCard PlausibleIn(double young_modulus, ParameterCard parameter) {
  if (!parameter.of_modulus) return parameter;
  parameter.plausible_min *= young_modulus / kReferenceModulus;
  parameter.plausible_max *= young_modulus / kReferenceModulus;
  return parameter;
}

std::string FamilyTitle(EffectFamily family) { return Find(family).title; }
std::string FamilyName(EffectFamily family) { return Find(family).name; }

EffectFamily FamilyFromName(const std::string& name) {
  for (const Family& entry : kFamilies)
    if (entry.name == name) return entry.family;
  throw InputError("unknown family of effects \"" + name + "\"");
}

}  // namespace lacuna
