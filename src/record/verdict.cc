#include "record/verdict.h"

#include <utility>

#include "record/tagged_json.h"

namespace lacuna {
namespace {

using nlohmann::json;

const std::vector<std::pair<Verdict, std::string>>& Names() {
  static const std::vector<std::pair<Verdict, std::string>> names{
      {Verdict::kAdequate, "adequate"},           {Verdict::kMissing, "missing"},
      {Verdict::kAmbiguous, "ambiguous"},         {Verdict::kNuisance, "nuisance"},
      {Verdict::kNotInLibrary, "not in library"}, {Verdict::kNoPower, "no power"}};
  return names;
}

}  // namespace

template <typename Visitor>
void VisitFields(Visitor& visit, NothingDetectable& /*reason*/) {
  visit.Kind("nothing_detectable");
}

template <typename Visitor>
void VisitFields(Visitor& visit, ErrorIsNoise& reason) {
  visit.Kind("error_is_noise");
  visit("rms_m", reason.rms);
  visit("rms_over_sigma", reason.rms_over_sigma);
}

template <typename Visitor>
void VisitFields(Visitor& visit, ErrorUnexplained& reason) {
  visit.Kind("error_unexplained");
  visit("rms_m", reason.rms);
  visit("rms_over_sigma", reason.rms_over_sigma);
  visit("best_evidence", reason.best_evidence);
}

template <typename Visitor>
void VisitFields(Visitor& visit, NuisanceExplains& reason) {
  visit.Kind("nuisance_explains");
  visit("nuisance_index", reason.nuisance);
  visit("explained_share", reason.share);
}

template <typename Visitor>
void VisitFields(Visitor& visit, ResidualRemains& reason) {
  visit.Kind("residual_remains");
  visit("effect", reason.effect);
  visit("explained_share_of_excess", reason.share);
  visit("rms_over_sigma", reason.rms_over_sigma);
}

template <typename Visitor>
void VisitFields(Visitor& visit, EvidenceForAnother& reason) {
  visit.Kind("evidence_for_another");
  visit("effect", reason.effect);
  visit("evidence", reason.evidence);
  visit("other", reason.other);
  visit("other_evidence", reason.other_evidence);
}

template <typename Visitor>
void VisitFields(Visitor& visit, EffectReducesError& reason) {
  visit.Kind("effect_reduces_error");
  visit("effect", reason.effect);
  visit("evidence", reason.evidence);
  visit("held_out", reason.held_out);
  visit("adjusted_for_nuisances", reason.adjusted_for_nuisances);
  visit("rms_over_sigma_before", reason.over_sigma_before);
  visit("rms_over_sigma_after", reason.over_sigma_after);
}

template <typename Visitor>
void VisitFields(Visitor& visit, AddAndDiagnose& step) {
  visit.Kind("add_and_diagnose");
  visit("effect", step.effect);
  visit("expected_next", step.expected_next);
}

template <typename Visitor>
void VisitFields(Visitor& visit, SeparateLookAlikes& step) {
  visit.Kind("separate_look_alikes");
  visit("effect", step.effect);
}

template <typename Visitor>
void VisitFields(Visitor& visit, CheckNuisance& step) {
  visit.Kind("check_nuisance");
  visit("nuisance_index", step.nuisance);
}

std::string VerdictName(Verdict verdict) {
  for (const auto& [value, name] : Names())
    if (value == verdict) return name;
  return "";
}

Verdict VerdictFromName(const std::string& name) {
  for (const auto& [value, text] : Names())
    if (text == name) return value;
  throw InputError("\"" + name + "\" is not a verdict");
}

json ConclusionToJson(const Conclusion& conclusion) {
  json reasons = json::array(), next_steps = json::array();
  for (const VerdictReason& reason : conclusion.reasons) reasons.push_back(TaggedToJson(reason));
  for (const SuggestedStep& step : conclusion.next_steps) next_steps.push_back(TaggedToJson(step));
  return {{"verdict", VerdictName(conclusion.verdict)},
          {"effects", conclusion.effects},
          {"reasons", reasons},
          {"next_steps", next_steps}};
}

Conclusion ConclusionFromJson(const json& value) {
  Conclusion conclusion;
  conclusion.verdict = VerdictFromName(value.at("verdict"));
  conclusion.effects = value.at("effects").get<std::vector<std::string>>();
  for (const json& reason : value.at("reasons"))
    conclusion.reasons.push_back(TaggedFromJson<VerdictReason>(reason));
  for (const json& step : value.at("next_steps"))
    conclusion.next_steps.push_back(TaggedFromJson<SuggestedStep>(step));
  return conclusion;
}

}  // namespace lacuna
