#include "exchange/inp_material.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>

#include "fem/lame_constants.h"

namespace lacuna {
namespace {

using Kind = PortableEffect::Kind;
using How = Counterpart::Kind;

double BulkModulus(const LameConstants& lame) { return lame.lambda + 2 * lame.mu / 3; }

Counterpart ElasticityCounterpart(const PortableEffect& law, InpDialect dialect) {
  const bool is_calculix = dialect != InpDialect::kAbaqus;
  switch (law.kind) {
    case Kind::kLinear:
      return {law.name, How::kExact, "*ELASTIC, in steps without NLGEOM"};
    case Kind::kSaintVenantKirchhoff:
      if (is_calculix) return {law.name, How::kExact, "*ELASTIC, in steps with NLGEOM"};
      return {law.name, How::kConverted,
              "*ELASTIC, in steps with NLGEOM: Abaqus uses the logarithmic strain in place of the "
              "Green-Lagrange strain; they agree to first order"};
    case Kind::kCorotational:
      return {
          law.name, How::kConverted,
          "*ELASTIC, in steps with NLGEOM: agrees to first order in the strain, at any rotation"};
    case Kind::kNeoHookean:
      return {
          law.name, How::kConverted,
          "*HYPERELASTIC, NEO HOOKE with C10 = mu/2, D1 = 2/K, mu = E/(2(1+nu)), K = "
          "E/(3(1-2nu)): the energy mu/2 (F:F-3) - mu (J-1) + (lambda+mu)/2 (J-1)^2 becomes C10 "
          "(J^(-2/3) F:F - 3) + (J-1)^2/D1, which agrees to second order in the strain, and "
          "where J = 1"};
    default:
      return {law.name, How::kNone, "the elasticity law has no counterpart"};
  }
}

bool HasMovingGrip(const PortableModel& model) {
  return std::any_of(model.grips.begin(), model.grips.end(),
                     [](const PortableGrip& grip) { return !grip.displacements.empty(); });
}

// Why a quasi-static motion is written without damping.
constexpr const char* kNoRates =
    "quasi-static steps of the program (*STATIC, *VISCO) have no velocities and therefore no "
    "damping; in Lacuna the change over a time step is the velocity";

Counterpart EffectCounterpart(const PortableEffect& effect, const PortableModel& model,
                              InpDialect dialect) {
  switch (effect.kind) {
    case Kind::kGravity:
      if (dialect == InpDialect::kCalculixPointMasses)
        return {effect.name, How::kExact, "*CLOAD, the weights of the nodes"};
      if (model.mesh.Order() == 1) return {effect.name, How::kExact, "*DLOAD, GRAV"};
      return {effect.name, How::kConverted,
              "*DLOAD, GRAV: weights of the elements, consistently distributed, in place of the "
              "weights of lumped masses"};
    case Kind::kMassDamping:
      if (model.is_static) return {effect.name, How::kNone, kNoRates};
      return {effect.name, How::kExact, "*DAMPING, ALPHA"};
    case Kind::kStiffnessDamping:
      if (model.is_static) return {effect.name, How::kNone, kNoRates};
      if (!model.IsProportional(effect))
        return {
            effect.name, How::kNone,
            "its Poisson's ratio is not that of the material, so that it is not proportional to "
            "the stiffness"};
      return {effect.name, How::kConverted,
              std::string("*DAMPING, BETA = beta E_damping/E: beta times the tangent stiffness in "
                          "place of stiffness at rest on the rate of the Green-Lagrange strain; "
                          "they agree for small strains and slow rotations") +
                  (dialect != InpDialect::kAbaqus && HasMovingGrip(model)
                       ? ". CalculiX leaves the velocity of nodes with a prescribed motion out of "
                         "the damping force, so that a moving grip brakes the body beside it"
                       : "")};
    case Kind::kViscoelasticBranch:
      if (dialect != InpDialect::kAbaqus)
        return {effect.name, How::kNone,
                "CalculiX has no linear viscoelasticity; the format abaqus has *VISCOELASTIC"};
      return {effect.name, How::kConverted,
              "*VISCOELASTIC, TIME=PRONY with g = mu_b/(mu + sum mu_b), k = K_b/(K + sum K_b) and "
              "long-term moduli; agrees to first order in the strain"};
    default:
      return {effect.name, How::kNone, "no keyword of the format describes it"};
  }
}

void AppendElasticity(const PortableModel& model, bool long_term, std::string* text) {
  const PortableEffect& law = model.Elasticity();
  CHECK(law.IsElasticity());
  const char* moduli = long_term ? ", MODULI=LONG TERM" : "";
  if (law.kind == Kind::kNeoHookean) {
    const LameConstants lame = LameFromYoung(law.values[0], law.values[1]);
    *text += fmt::format("*HYPERELASTIC, NEO HOOKE{}\n{}, {}\n", moduli, InpNumber(lame.mu / 2),
                         InpNumber(2 / BulkModulus(lame)));
  } else {
    *text += fmt::format("*ELASTIC{}\n{}, {}\n", moduli, InpNumber(law.values[0]),
                         InpNumber(law.values[1]));
  }
}

void AppendBranches(const PortableModel& model, std::string* text) {
  const PortableEffect& law = model.Elasticity();
  LameConstants sum = LameFromYoung(law.values[0], law.values[1]);
  for (const PortableEffect& effect : model.effects) {
    if (effect.kind != Kind::kViscoelasticBranch) continue;
    const LameConstants branch = LameFromYoung(effect.values[0], effect.values[2]);
    sum = {sum.lambda + branch.lambda, sum.mu + branch.mu};
  }
  *text += "*VISCOELASTIC, TIME=PRONY\n";
  for (const PortableEffect& effect : model.effects) {
    if (effect.kind != Kind::kViscoelasticBranch) continue;
    const LameConstants branch = LameFromYoung(effect.values[0], effect.values[2]);
    *text +=
        fmt::format("{}, {}, {}\n", InpNumber(branch.mu / sum.mu),
                    InpNumber(BulkModulus(branch) / BulkModulus(sum)), InpNumber(effect.values[1]));
  }
}

}  // namespace

std::string InpNumber(double value) { return fmt::format("{:.13g}", value); }

Counterparts InpCounterparts(const PortableModel& model, InpDialect dialect) {
  Counterparts parts{ElasticityCounterpart(model.Elasticity(), dialect)};
  for (size_t k = 1; k < model.effects.size(); ++k)
    parts.push_back(EffectCounterpart(model.effects[k], model, dialect));
  for (const PortableGrip& grip : model.grips)
    parts.push_back({"grip " + grip.part.name, How::kExact,
                     grip.displacements.empty() ? "*BOUNDARY"
                                                : "*BOUNDARY with *AMPLITUDE, linear between times "
                                                  "at most one time step apart"});
  for (const PortableLoad& load : model.loads)
    parts.push_back({"force " + load.part.name, How::kExact, "*CLOAD with *AMPLITUDE"});
  if (model.held_force.size() > 0)
    parts.push_back({"hold", How::kExact, "*CLOAD in the first step, removed in the second"});
  if (model.HasInertia())
    parts.push_back(
        {"inertia", How::kConverted,
         dialect == InpDialect::kCalculixPointMasses
             ? "lumped masses as *MASS, elements with a billionth of the density; *DYNAMIC in "
               "place of Lacuna's time scheme"
             : "the masses of the elements (consistent, or as the program chooses) in place of "
               "lumped ones; *DYNAMIC in place of Lacuna's time scheme"});
  else if (dialect == InpDialect::kCalculixPointMasses)
    parts.push_back({"density", How::kConverted,
                     "*MASS at the nodes; *DENSITY is a billionth of the material's"});
  return parts;
}

bool IsGeometricallyNonlinear(const PortableModel& model) {
  return model.Elasticity().kind != Kind::kLinear;
}

std::string InpMaterial(const PortableModel& model, InpDialect dialect) {
  std::string text = "*MATERIAL, NAME=LACUNA\n";
  const bool has_branches =
      dialect == InpDialect::kAbaqus && model.Find(Kind::kViscoelasticBranch) != nullptr;
  AppendElasticity(model, has_branches, &text);
  if (has_branches) AppendBranches(model, &text);
  // CalculiX wants elements with a mass; this one is below the rounding of its results.
  constexpr double kAlmostNone = 1e-9;
  const bool has_point_masses = dialect == InpDialect::kCalculixPointMasses;
  text += fmt::format("*DENSITY\n{}\n",
                      InpNumber(has_point_masses ? kAlmostNone * model.density : model.density));
  const RayleighDamping damping = model.is_static ? RayleighDamping() : model.Damping();
  if (damping.alpha > 0 || damping.beta > 0)
    text += fmt::format("*DAMPING, ALPHA={}, BETA={}\n", InpNumber(damping.alpha),
                        InpNumber(damping.beta));
  return text;
}

}  // namespace lacuna
