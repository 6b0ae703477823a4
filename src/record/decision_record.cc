#include "record/decision_record.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "core/error.h"
#include "core/json_number.h"

namespace lacuna {
namespace {

using nlohmann::json;
using Kind = HypothesisProbability::Kind;

constexpr std::pair<Kind, const char*> kKinds[] = {{Kind::kNothing, "nothing"},
                                                   {Kind::kEffect, "effect"},
                                                   {Kind::kNuisance, "nuisance"},
                                                   {Kind::kPair, "pair"}};

Kind KindFromName(const std::string& name) {
  for (const auto& [kind, known] : kKinds)
    if (known == name) return kind;
  throw InputError("unknown kind of hypothesis \"" + name + "\"");
}

}  // namespace

std::string HypothesisKindName(Kind kind) {
  for (const auto& [known, name] : kKinds)
    if (known == kind) return name;
  return "";
}

double DecisionRecord::FamilyProbability(EffectFamily family) const {
  double sum = 0;
  for (const HypothesisProbability& one : probabilities)
    if (one.kind == Kind::kEffect && one.family == family) sum += one.probability;
  return sum;
}

json ProbabilitiesToJson(const std::vector<HypothesisProbability>& probabilities) {
  json all = json::array();
  for (const HypothesisProbability& one : probabilities)
    all.push_back({{"kind", HypothesisKindName(one.kind)},
                   {"names", one.names},
                   {"family", FamilyName(one.family)},
                   {"evidence", NumberOrNull(one.evidence)},
                   {"probability", one.probability},
                   {"is_refuted", one.is_refuted}});
  return all;
}

json PowerToJson(const RecordedPower& power) {
  return {
      {"truth", power.truth},          {"named", power.named}, {"wrong_member", power.wrong_member},
      {"wrong", power.wrong},          {"open", power.open},   {"unknown", power.unknown},
      {"most_wrong", power.most_wrong}};
}

RecordedPower PowerFromJson(const json& value) {
  return {value.at("truth"), value.at("named"),   value.at("wrong_member"), value.at("wrong"),
          value.at("open"),  value.at("unknown"), value.at("most_wrong")};
}

json DecisionToJson(const DecisionRecord& decision) {
  json power = json::array(), separations = json::array();
  for (const RecordedPower& one : decision.power) power.push_back(PowerToJson(one));
  for (const RecordedSeparation& one : decision.separations)
    separations.push_back(
        {{"first", one.first}, {"second", one.second}, {"lambda", NumberOrNull(one.lambda)}});
  const RecordedAdequacy& adequacy = decision.adequacy;
  return {{"probabilities", ProbabilitiesToJson(decision.probabilities)},
          {"adequacy",
           {{"beside", adequacy.beside},
            {"p_unknown_force", NumberOrNull(adequacy.p_unknown_force)},
            {"p_further", adequacy.p_further},
            {"p_variance", NumberOrNull(adequacy.p_variance)},
            {"p", adequacy.p},
            {"is_adequate", adequacy.is_adequate},
            {"further", adequacy.further},
            {"further_evidence", NumberOrNull(adequacy.further_evidence)},
            {"rms_over_sigma", adequacy.rms_over_sigma},
            {"left_share", NumberOrNull(adequacy.left_share)},
            {"is_tolerated", adequacy.is_tolerated}}},
          {"power", power},
          {"separations", separations},
          {"chance", NumberOrNull(decision.chance)}};
}

std::vector<HypothesisProbability> ProbabilitiesFromJson(const json& value) {
  std::vector<HypothesisProbability> probabilities;
  for (const json& one : value)
    probabilities.push_back({KindFromName(one.at("kind")), one.at("names"),
                             FamilyFromName(one.at("family")), NumberOr(one.at("evidence")),
                             one.at("probability"), one.at("is_refuted")});
  return probabilities;
}

DecisionRecord DecisionFromJson(const json& value) {
  DecisionRecord decision;
  decision.probabilities = ProbabilitiesFromJson(value.at("probabilities"));
  for (const json& one : value.at("power")) decision.power.push_back(PowerFromJson(one));
  for (const json& one : value.at("separations"))
    decision.separations.push_back({one.at("first"), one.at("second"), NumberOr(one.at("lambda"))});
  const json& adequacy = value.at("adequacy");
  decision.adequacy = {adequacy.at("beside"),
                       NumberOr(adequacy.value("p_unknown_force", json())),
                       adequacy.at("p_further"),
                       NumberOr(adequacy.value("p_variance", json())),
                       adequacy.at("p"),
                       adequacy.at("is_adequate"),
                       adequacy.at("further"),
                       NumberOr(adequacy.at("further_evidence")),
                       adequacy.at("rms_over_sigma"),
                       NumberOr(adequacy.at("left_share")),
                       adequacy.at("is_tolerated")};
  decision.chance = NumberOr(value.at("chance"));
  return decision;
}

}  // namespace lacuna
