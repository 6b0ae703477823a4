#include "report/diagnosis_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <vector>

#include "core/quantity.h"
#include "core/text_layout.h"
#include "report/agreement_text.h"
#include "report/quantity_text.h"
#include "report/verdict_text.h"

namespace lacuna {
namespace {

// Effects that were not refitted and whose evidence does not exceed this are listed in one line.
constexpr double kWorthALine = 0;

std::string Paragraph(const std::string& text, const std::string& first = "  ") {
  return Wrapped(text, first, "  ");
}

std::string Percent(double share) { return fmt::format("{:.0f} %", 100 * share); }

std::string Millimetres(const ModelErrors& errors) {
  return fmt::format("{:.3f} mm", 1e3 * errors.held_out_rms);
}

std::string Sizes(const RecordedEffect& effect) {
  std::vector<std::string> sizes;
  for (const RecordedSize& size : effect.sizes)
    sizes.push_back(size.refitted ? fmt::format("{:.3g} [{:.3g}, {:.3g}]", size.refitted->value,
                                                size.refitted->low, size.refitted->high)
                                  : fmt::format("{:.3g} ± {:.2g}", size.expected, size.deviation));
  const std::string all = fmt::format("{}", fmt::join(sizes, ", "));
  return WithUnit(sizes.size() > 1 ? "(" + all + ")" : all, effect.sizes.front().unit);
}

// Which sizes of a refit have ended at the limit of what is plausible; empty where none has.
std::string SizesAtLimit(const RecordedEffect& effect) {
  std::vector<std::string> names;
  for (const RecordedSize& size : effect.sizes)
    if (size.refitted && size.at_limit) names.push_back(size.parameter);
  if (names.empty()) return "";
  return fmt::format("{} {} at the limit of what is plausible, where {} cut off",
                     EnumerationText(names), names.size() > 1 ? "are" : "is",
                     names.size() > 1 ? "their intervals are" : "its interval is");
}

std::string RefittedError(const RecordedEffect& effect) {
  if (!effect.refit) return "";
  if (!effect.HasUsableRefit()) return "not usable";
  return fmt::format("{:.1f} σ", effect.refit->errors.without_nuisances);
}

std::string Row(const std::vector<std::string>& cells) {
  constexpr size_t kWidths[] = {9, 9, 9, 11, 11, 10};
  std::string line = "  " + PaddedRight(cells[0], 22);
  for (size_t k = 0; k < std::size(kWidths); ++k) line += PaddedLeft(cells[k + 1], kWidths[k]);
  line += "  " + cells.back();
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

// The parameters of a refit other than the effect's size, e.g. "centre_x 0.05 [0.04, 0.06] m".
std::string OtherParameters(const RecordedRefit& refit) {
  std::vector<std::string> others;
  for (const RecordedValue& other : refit.others)
    others.push_back(WithUnit(fmt::format("{} {:.3g} [{:.3g}, {:.3g}]",
                                          other.parameter.substr(other.parameter.find('.') + 1),
                                          other.found.value, other.found.low, other.found.high),
                              other.unit));
  return fmt::format("{}", fmt::join(others, ", "));
}

// "62 % belongs to the markers and 38 % to the forces"
std::string SharesText(const ByDataKind& removed) {
  double all = 0;
  for (const auto& [name, kind] : kDataKinds) all += removed.*kind;
  std::vector<std::string> parts;
  for (const auto& [name, kind] : kDataKinds)
    if (removed.*kind != 0)
      parts.push_back(fmt::format("{}{} to the {}", PercentText(removed.*kind / all),
                                  parts.empty() ? " belongs" : "", name));
  return EnumerationText(parts);
}

// "the squared misfit of the markers by -34.0 σ² and that of the forces by +2.5 σ²"
std::string ChangesText(const ByDataKind& removed) {
  std::vector<std::string> parts;
  for (const auto& [name, kind] : kDataKinds)
    if (removed.*kind != 0)
      parts.push_back(fmt::format("{} of the {} by {:+.1f} σ²",
                                  parts.empty() ? "the squared misfit" : "that", name,
                                  -(removed.*kind)));
  return EnumerationText(parts);
}

// From which kinds of data an effect removes squared misfit, and to which it adds some. Kinds that
// the recordings do not have are 0.
std::string RemovedMisfitText(const ByDataKind& removed) {
  bool adds = false, removes = false;
  for (const auto& [name, kind] : kDataKinds) {
    adds = adds || removed.*kind < 0;
    removes = removes || removed.*kind > 0;
  }
  if (adds) return "it changes " + ChangesText(removed);
  return removes ? "of the squared misfit that it removes, " + SharesText(removed) : "";
}

std::string EffectLines(const RecordedEffect& effect) {
  const bool usable = effect.HasUsableRefit();
  std::string text =
      Row({effect.type, fmt::format("{:.1f}", effect.first_order.evidence),
           usable ? fmt::format("{:.1f}", effect.refit->evidence) : "",
           fmt::format("{:.1f} σ", effect.first_order.held_out_rms_over_sigma),
           RefittedError(effect), usable ? Millimetres(effect.refit->errors) : "",
           Percent(effect.first_order.absorbed), effect.sizes.size() == 1 ? Sizes(effect) : ""});
  std::vector<std::string> more;
  if (effect.sizes.size() > 1) more.push_back(Sizes(effect));
  if (std::string limit = SizesAtLimit(effect); usable && !limit.empty())
    more.push_back(std::move(limit));
  if (!effect.variant.empty()) more.push_back((usable ? "refitted from " : "") + effect.variant);
  if (usable && !effect.refit->others.empty())
    more.push_back("to " + OtherParameters(*effect.refit));
  if (!effect.look_alikes.empty())
    more.push_back(fmt::format("looks like {}", fmt::join(effect.look_alikes, ", ")));
  if (usable && effect.refit->removed)
    if (std::string removed = RemovedMisfitText(*effect.refit->removed); !removed.empty())
      more.push_back(std::move(removed));
  if (effect.refit && !usable) more.push_back(effect.refit->message);
  if (usable && !effect.refit->unconverged.empty()) more.push_back(effect.refit->unconverged);
  if (!more.empty()) text += Wrapped(fmt::format("{}", fmt::join(more, "; ")), "      ", "      ");
  return text;
}

std::string RankingTable(const DiagnosisRecord& diagnosis) {
  std::string text = fmt::format(
      "\n  {}{}{}{}\n", PaddedRight("", 22), PaddedLeft("evidence", 18),
      PaddedLeft(diagnosis.errors.has_held_out ? "error, held out" : "error, fitted", 31),
      PaddedLeft("share", 10));
  text += Row({"effect", "expected", "refitted", "expected", "refitted", "raw", "absorbed",
               "size [95 %] or ±"});
  text += Row({"(the fitted model)", "", "", "",
               fmt::format("{:.1f} σ", diagnosis.errors.without_nuisances),
               Millimetres(diagnosis.errors), "", ""});
  std::vector<std::string> quiet;
  for (const RecordedEffect& effect : diagnosis.ranking) {
    if (effect.refit || effect.first_order.evidence > kWorthALine)
      text += EffectLines(effect);
    else
      quiet.push_back(effect.type);
  }
  text += Paragraph(
      "Errors in σ exclude the contributions of mesh, time step and the other adopted nuisances; "
      "raw errors include them.");
  if (!quiet.empty()) text += Paragraph(fmt::format("no evidence for: {}", fmt::join(quiet, ", ")));
  for (const UntriedEffect& effect : diagnosis.untried)
    text += Paragraph(fmt::format("not tried: {}; {}", effect.type, effect.why));
  return text;
}

std::string NuisanceTable(const DiagnosisRecord& diagnosis) {
  std::string text =
      fmt::format("\n  {}{}{}{}\n", PaddedRight("nuisance", 22), PaddedLeft("evidence", 9),
                  PaddedLeft("refitted", 9), PaddedLeft("explains", 10));
  std::vector<std::string> quiet;
  for (const RecordedNuisance& nuisance : diagnosis.nuisances) {
    if (!nuisance.adopted && nuisance.evidence <= kWorthALine) {
      if (std::count(quiet.begin(), quiet.end(), nuisance.name) == 0)
        quiet.push_back(nuisance.name);
      continue;
    }
    std::string line = fmt::format(
        "  {}{}{}{}   {}", PaddedRight(nuisance.name, 22),
        PaddedLeft(fmt::format("{:.1f}", nuisance.evidence), 9),
        PaddedLeft(nuisance.refitted ? fmt::format("{:.1f}", *nuisance.refitted) : "", 9),
        PaddedLeft(Percent(nuisance.explained), 10),
        nuisance.adopted ? "in the model" : nuisance.what);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  if (!quiet.empty()) text += Paragraph(fmt::format("no evidence for: {}", fmt::join(quiet, ", ")));
  return text;
}

std::string AlternativesTable(const DiagnosisRecord& diagnosis) {
  if (diagnosis.alternatives.effects.empty()) return "";
  std::string text =
      fmt::format("\n  in place of the adopted nuisances, whose evidence is {:.1f}\n",
                  diagnosis.alternatives.nuisances_evidence);
  for (const RecordedEffect& effect : diagnosis.alternatives.effects) text += EffectLines(effect);
  return text;
}

std::string NoiseParagraph(const DiagnosisRecord& diagnosis) {
  const RecordedNoise& noise = diagnosis.noise;
  std::vector<std::string> sigma;
  if (noise.coordinate > 0)
    sigma.push_back(fmt::format("{:.3g} mm per marker coordinate", 1e3 * noise.coordinate));
  if (noise.scanned_point > 0)
    sigma.push_back(fmt::format("{:.3g} mm per scanned point", 1e3 * noise.scanned_point));
  std::string text = fmt::format(
      "Noise: σ = {}, {}.", fmt::join(sigma, " and "),
      noise.correlation_time > 0 ? fmt::format("correlated over {:.3g} s", noise.correlation_time)
                                 : "white in time");
  text += fmt::format(" The residual of the best-fitting model is {:.1f} σ. Time step: {}.",
                      diagnosis.best_rms_over_sigma, DurationText(diagnosis.time_step));
  if (std::isfinite(diagnosis.decision.chance))
    text += fmt::format(
        " If nothing is missing, the evidence for the best effect exceeds {:.1f} by chance in one "
        "of "
        "20 such recordings.",
        diagnosis.decision.chance);
  return Paragraph(text);
}

// What these recordings would have said, had one of the hypotheses been true.
std::string PowerTable(const DecisionRecord& decision) {
  if (decision.power.empty()) return "";
  std::string text = fmt::format(
      "\n  Had this been missing, at the size that was found, such recordings would have\n"
      "  {}{}{}{}{}{}\n",
      PaddedRight("", 22), PaddedLeft("named it", 10), PaddedLeft("named a relative", 18),
      PaddedLeft("another", 9), PaddedLeft("left open", 11), PaddedLeft("said unknown", 14));
  for (const RecordedPower& one : decision.power) {
    text += fmt::format(
        "  {}{}{}{}{}{}{}\n", PaddedRight(one.truth.empty() ? "nothing" : one.truth.front(), 22),
        PaddedLeft(Percent(one.named), 10), PaddedLeft(Percent(one.wrong_member), 18),
        PaddedLeft(Percent(one.wrong), 9), PaddedLeft(Percent(one.open), 11),
        PaddedLeft(Percent(one.unknown), 14),
        one.most_wrong.empty() ? "" : "   mistaken for " + one.most_wrong);
  }
  std::vector<std::string> pairs;
  constexpr double kSeparable = 12;
  for (const RecordedSeparation& pair : decision.separations)
    if (pair.lambda < kSeparable)
      pairs.push_back(fmt::format("{} and {} (λ = {:.1f})", pair.first, pair.second, pair.lambda));
  if (!pairs.empty())
    text += Paragraph(fmt::format(
        "These recordings cannot separate {}; λ is the squared distance of their predictions in "
        "units of the noise, and 12 would separate two effects in four cases of five.",
        fmt::join(pairs, ", ")));
  return text;
}

std::string AgreementLines(const AgreementRecord& agreement) {
  if (agreement.recordings.empty()) return "";
  return "\n" + AgreementTable(agreement) + Paragraph(ExplainAgreement(agreement));
}

std::string DetectableTable(const DiagnosisRecord& diagnosis) {
  std::string text = "\n  Smallest size that these recordings would reveal\n";
  for (const RecordedEffect& effect : diagnosis.ranking) {
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (const RecordedSize& size : effect.sizes) {
      least = std::min(least, size.detectable);
      most = std::max(most, size.detectable);
    }
    const std::string& unit = effect.sizes.front().unit;
    const std::string sizes = !std::isfinite(least) ? "no size would be detectable"
                              : least == most
                                  ? WithUnit(fmt::format("{:.2g}", least), unit)
                                  : WithUnit(fmt::format("{:.2g} to {:.2g}", least, most), unit) +
                                        ", depending on the direction";
    text += fmt::format("    {}{}\n", PaddedRight(effect.type, 24), sizes);
  }
  return text;
}

std::string WhatNext(const DiagnosisRecord& diagnosis, const CalibrationRecord& fit,
                     const std::filesystem::path& run) {
  if (diagnosis.verdict == Verdict::kMissing)
    return fmt::format(
        "lacuna add {0} {1}, or lacuna diagnose {0} --until-done; lacuna explain {1}", run.string(),
        diagnosis.effects.front());
  if (const std::optional<std::string> part = PartlyExplainedBy(diagnosis))
    return fmt::format(
        "lacuna diagnose {0} --until-done adds {1} and diagnoses what is left; lacuna compare {0} "
        "shows where and when the model fails",
        run.string(), *part);
  if (!diagnosis.next_steps.empty()) {
    const std::string steps = DescribeNextSteps(diagnosis);
    return diagnosis.verdict == Verdict::kAmbiguous && HasPlannableRecording(fit)
               ? fmt::format("{}; lacuna plan {} computes which recording would decide", steps,
                             run.string())
               : steps;
  }
  if (diagnosis.verdict == Verdict::kNotInLibrary)
    return fmt::format(
        "lacuna compare {} shows where and when the model fails; docs/expression.md explains how "
        "to try a user-defined force law",
        run.string());
  return "";
}

}  // namespace

std::string DiagnosisReport(const DiagnosisRecord& diagnosis, const CalibrationRecord& fit,
                            const std::filesystem::path& run) {
  std::string text = "\n" + VerdictWithNames(diagnosis) + "\n";
  text += Paragraph(ExplainVerdict(diagnosis));
  text += NoiseParagraph(diagnosis);
  text += RankingTable(diagnosis);
  text += NuisanceTable(diagnosis);
  text += AlternativesTable(diagnosis);
  text += PowerTable(diagnosis.decision);
  text += AgreementLines(diagnosis.agreement);
  if (diagnosis.verdict == Verdict::kAdequate || diagnosis.verdict == Verdict::kNoPower)
    text += DetectableTable(diagnosis);
  const std::string next = WhatNext(diagnosis, fit, run);
  if (!next.empty()) text += "\n" + Paragraph(next, "next: ");
  return text + fmt::format("\n{} contains all results\n",
                            (run / "diagnosis" / "diagnosis.json").string());
}

}  // namespace lacuna
