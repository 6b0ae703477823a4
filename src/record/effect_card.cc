#include "record/effect_card.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

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

// The exponents with which a unit is a product of E, ρ and L.
struct BodyUnit {
  double modulus = 0, density = 0, length = 0;
};
BodyUnit BodyUnitOf(const Dimension& dimension) {
  BodyUnit unit;  // of E, kg/(m s²), and ρ, kg/m³
  unit.modulus = -0.5 * dimension.second;
  unit.density = dimension.kilogram - unit.modulus;
  unit.length = dimension.metre + unit.modulus + 3 * unit.density;
  return unit;
}

}  // namespace

ParameterCard PlausibleIn(const BodyScale& body, ParameterCard parameter) {
  if (!parameter.of_body) return parameter;
  const BodyUnit unit = BodyUnitOf(parameter.dimension);
  const double ratio = std::pow(body.young_modulus / kReferenceBody.young_modulus, unit.modulus) *
                       std::pow(body.density / kReferenceBody.density, unit.density) *
                       std::pow(body.length / kReferenceBody.length, unit.length);
  parameter.plausible_min *= ratio;
  parameter.plausible_max *= ratio;
  return parameter;
}

std::string BodyUnitText(const Dimension& dimension) {
  const BodyUnit unit = BodyUnitOf(dimension);
  std::vector<std::string> factors;
  const auto add = [&](const char* symbol, double exponent) {
    if (exponent == 0) return;
    factors.push_back(exponent == 1 ? symbol : fmt::format("{}^{:g}", symbol, exponent));
  };
  add("E", unit.modulus);
  add("ρ", unit.density);
  add("L", unit.length);
  return fmt::format("{}", fmt::join(factors, " "));
}

std::string FamilyTitle(EffectFamily family) { return Find(family).title; }
std::string FamilyName(EffectFamily family) { return Find(family).name; }

EffectFamily FamilyFromName(const std::string& name) {
  for (const Family& entry : kFamilies)
    if (entry.name == name) return entry.family;
  throw InputError("unknown family of effects \"" + name + "\"");
}

}  // namespace lacuna
