#include "app/diagnosis_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/text_layout.h"

namespace lacuna {
namespace {

// Effects that were not refitted and have less evidence are named in one line.
constexpr double kWorthALine = 0;

void PrintText(const std::string& text, const std::string& first = "  ") {
  fmt::print("{}", Wrapped(text, first, "  "));
}

std::string Percent(double share) { return fmt::format("{:.0f} %", 100 * share); }

std::string SizeText(const RecordedEffect& effect) {
  std::vector<std::string> sizes;
  for (const RecordedSize& size : effect.sizes)
    sizes.push_back(size.refitted ? fmt::format("{:.3g} [{:.3g}, {:.3g}]", size.refitted->value,
                                                size.refitted->low, size.refitted->high)
                                  : fmt::format("{:.3g} ± {:.2g}", size.expected, size.deviation));
  const std::string all = fmt::format("{}", fmt::join(sizes, ", "));
  const std::string unit = effect.sizes.front().unit;
  return (effect.sizes.size() > 1 ? "(" + all + ")" : all) + (unit.empty() ? "" : " " + unit);
}

std::string RefitText(const RecordedEffect& effect) {
  if (!effect.refitted) return "";
  if (!effect.refit_message.empty()) return "not usable";
  return fmt::format("{:.1f} σ", effect.errors.without_nuisances);
}

std::string MillimetreText(const ModelErrors& errors) {
  return fmt::format("{:.3f} mm", 1e3 * errors.held_out_rms);
}

void PrintRow(const std::vector<std::string>& cells) {
  constexpr size_t kWidths[] = {9, 9, 9, 11, 11, 10};
  std::string line = "  " + PaddedRight(cells[0], 22);
  for (size_t k = 0; k < std::size(kWidths); ++k) line += PaddedLeft(cells[k + 1], kWidths[k]);
  line += "  " + cells.back();
  line.erase(line.find_last_not_of(' ') + 1);
  fmt::print("{}\n", line);
}

void PrintEffect(const RecordedEffect& effect) {
  PrintRow({effect.type, fmt::format("{:.1f}", effect.evidence),
            effect.HasUsableRefit() ? fmt::format("{:.1f}", effect.refit_evidence) : "",
            fmt::format("{:.1f} σ", effect.expected_in_noise), RefitText(effect),
            effect.HasUsableRefit() ? MillimetreText(effect.errors) : "", Percent(effect.absorbed),
            effect.sizes.size() == 1 ? SizeText(effect) : ""});
  std::vector<std::string> more;
  if (effect.sizes.size() > 1) more.push_back(SizeText(effect));
  if (!effect.variant.empty())
    more.push_back((effect.HasUsableRefit() ? "refitted from " : "") + effect.variant);
  std::vector<std::string> others;
  for (const RecordedValue& other : effect.others)
    others.push_back(fmt::format("{} {:.3g} [{:.3g}, {:.3g}]{}{}",
                                 other.parameter.substr(other.parameter.find('.') + 1),
                                 other.found.value, other.found.low, other.found.high,
                                 other.unit.empty() ? "" : " ", other.unit));
  if (!others.empty()) more.push_back(fmt::format("to {}", fmt::join(others, ", ")));
  if (!effect.look_alikes.empty())
    more.push_back(fmt::format("looks like {}", fmt::join(effect.look_alikes, ", ")));
  if (!effect.refit_message.empty()) more.push_back(effect.refit_message);
  if (!more.empty())
    fmt::print("{}", Wrapped(fmt::format("{}", fmt::join(more, "; ")), "      ", "      "));
}

void PrintRanking(const DiagnosisRecord& diagnosis) {
  fmt::print("\n  {}{}{}{}\n", PaddedRight("", 22), PaddedLeft("evidence", 18),
             PaddedLeft(diagnosis.errors.has_held_out ? "error, held out" : "error, fitted", 31),
             PaddedLeft("share", 10));
  // In σ less what the nuisances in the model do, which is what is judged; in mm with that.
  PrintRow({"effect", "expected", "refitted", "expected", "refitted", "raw", "absorbed",
            "size [95 %] or ±"});
  PrintRow({"(the model as it is)", "", "", "",
            fmt::format("{:.1f} σ", diagnosis.errors.without_nuisances),
            MillimetreText(diagnosis.errors), "", ""});
  std::vector<std::string> quiet;
  for (const RecordedEffect& effect : diagnosis.ranking) {
    if (effect.refitted || effect.evidence > kWorthALine)
      PrintEffect(effect);
    else
      quiet.push_back(effect.type);
  }
  PrintText("σ: less what mesh, step and other nuisances in the model do; raw: with that");
  if (!quiet.empty()) PrintText(fmt::format("no sign of: {}", fmt::join(quiet, ", ")));
  for (const UntriedEffect& effect : diagnosis.untried)
    PrintText(fmt::format("not tried: {}; {}", effect.type, effect.why));
}

void PrintNuisances(const DiagnosisRecord& diagnosis) {
  std::vector<std::string> lines, quiet;
  for (const RecordedNuisance& nuisance : diagnosis.nuisances) {
    if (!nuisance.adopted && nuisance.evidence <= kWorthALine) {
      if (std::count(quiet.begin(), quiet.end(), nuisance.name) == 0)
        quiet.push_back(nuisance.name);
      continue;
    }
    lines.push_back(fmt::format(
        "  {}{}{}{}   {}", PaddedRight(nuisance.name, 22),
        PaddedLeft(fmt::format("{:.1f}", nuisance.evidence), 9),
        PaddedLeft(nuisance.refitted ? fmt::format("{:.1f}", *nuisance.refitted) : "", 9),
        PaddedLeft(Percent(nuisance.explained), 10),
        nuisance.adopted ? "in the model" : nuisance.what));
    lines.back().erase(lines.back().find_last_not_of(' ') + 1);
  }
  fmt::print("\n  {}{}{}{}\n", PaddedRight("nuisance", 22), PaddedLeft("evidence", 9),
             PaddedLeft("refitted", 9), PaddedLeft("explains", 10));
  for (const std::string& line : lines) fmt::print("{}\n", line);
  if (!quiet.empty()) PrintText(fmt::format("no sign of: {}", fmt::join(quiet, ", ")));
}

void PrintInstead(const DiagnosisRecord& diagnosis) {
  if (diagnosis.instead.empty()) return;
  fmt::print("\n  in place of the nuisances in the model, whose evidence is {:.1f}\n",
             diagnosis.nuisances_evidence);
  for (const RecordedEffect& effect : diagnosis.instead) PrintEffect(effect);
}

void PrintNoise(const DiagnosisRecord& diagnosis) {
  std::string sigma;
  if (diagnosis.noise > 0) sigma = fmt::format("{:.3g} mm of a coordinate", 1e3 * diagnosis.noise);
  if (diagnosis.scan_noise > 0)
    sigma += fmt::format("{}{:.3g} mm of a scanned point", sigma.empty() ? "" : " and ",
                         1e3 * diagnosis.scan_noise);
  std::string text =
      fmt::format("Noise: σ = {}, {}", sigma,
                  diagnosis.correlation_time > 0
                      ? fmt::format("correlated over {:.3g} s", diagnosis.correlation_time)
                      : "white in time");
  text += fmt::format("; the best hypothesis leaves {:.1f} σ. Time step: {:.3g} ms.",
                      diagnosis.left_in_noise, 1e3 * diagnosis.time_step);
  if (diagnosis.control > 0)
    text += fmt::format(" Control: without any effect, evidence up to {:.1f} comes by chance.",
                        diagnosis.control);
  PrintText(text);
}

// What these recordings would have shown.
void PrintDetectable(const DiagnosisRecord& diagnosis) {
  fmt::print("\n  Smallest size that these recordings could have shown\n");
  for (const RecordedEffect& effect : diagnosis.ranking) {
    double least = INFINITY, most = 0;
    for (const RecordedSize& size : effect.sizes) {
      least = std::min(least, size.detectable);
      most = std::max(most, size.detectable);
    }
    const std::string unit =
        effect.sizes.front().unit.empty() ? "" : " " + effect.sizes.front().unit;
    const std::string text =
        !std::isfinite(least) ? "any size stays unseen"
        : least == most       ? fmt::format("{:.2g}{}", least, unit)
                              : fmt::format("{:.2g} to {:.2g}{}, by direction", least, most, unit);
    fmt::print("    {}{}\n", PaddedRight(effect.type, 24), text);
  }
}

std::string WhatNext(const DiagnosisRecord& diagnosis, const std::filesystem::path& run) {
  const std::string& verdict = diagnosis.verdict;
  if (verdict == "missing")
    return fmt::format(
        "lacuna add {0} {1}, or lacuna diagnose {0} --until-done; lacuna explain {1}", run.string(),
        diagnosis.effects.front());
  if (!diagnosis.experiment.empty()) return diagnosis.experiment;
  if (verdict == "not in library")
    return fmt::format(
        "lacuna compare {} shows where and when it fails; docs/expression.md, how to try a force "
        "law of your own",
        run.string());
  return "";
}

}  // namespace

void PrintDiagnosis(const DiagnosisRecord& diagnosis, const std::filesystem::path& run) {
  fmt::print(
      "\n{}{}\n", diagnosis.verdict,
      diagnosis.effects.empty() ? "" : fmt::format(" {{{}}}", fmt::join(diagnosis.effects, ", ")));
  PrintText(diagnosis.explanation);
  PrintNoise(diagnosis);
  PrintRanking(diagnosis);
  PrintNuisances(diagnosis);
  PrintInstead(diagnosis);
  if (diagnosis.verdict == "adequate" || diagnosis.verdict == "no power")
    PrintDetectable(diagnosis);
  const std::string next = WhatNext(diagnosis, run);
  if (!next.empty()) {
    fmt::print("\n");
    PrintText(next, "next: ");
  }
  fmt::print("\n{} holds all of it\n", (run / "diagnosis" / "diagnosis.json").string());
}

}  // namespace lacuna
