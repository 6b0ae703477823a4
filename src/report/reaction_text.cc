#include "report/reaction_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace lacuna {
namespace {

std::string Describe(const ReactionMeasure& measure) {
  if (measure.values == 0) return "-";
  return fmt::format("{:.3g} N (largest {:.3g}), {:.1f} σ, {} frames", measure.rms, measure.largest,
                     measure.rms_over_sigma, measure.frames);
}

std::string NoiseAndTare(const FittedReaction& reaction) {
  std::string text =
      fmt::format("σ = {:.3g} N{}", reaction.deviation,
                  reaction.deviation_is_estimated ? ", estimated from the reading" : "");
  if (reaction.tare_deviation > 0)
    text += fmt::format("; tare {:.3g} N (prior ± {:.3g} N)", fmt::join(reaction.tare, ", "),
                        reaction.tare_deviation);
  return text;
}

}  // namespace

std::string ReactionLines(const FittedReaction& reaction) {
  return fmt::format("  {:14} fitted    {}\n  {:14} held out  {}\n  {:14} {}\n",
                     "force on " + reaction.name, Describe(reaction.in_fit), "",
                     Describe(reaction.held_out), "", NoiseAndTare(reaction));
}

std::string DescribeReactionFit(const FittedReaction& reaction, const std::string& recording) {
  std::string text =
      fmt::format("{}, force on {} ({}; the largest reading is {:.3g} N):", recording,
                  reaction.name, fmt::join(reaction.labels, ", "), reaction.largest_reading);
  const auto add = [&](const char* frames, const ReactionMeasure& measure) {
    if (measure.values == 0) return;
    text += fmt::format(
        " in the {} frames the rms error of a component is {:.3g} N, {:.1f} σ, and the largest "
        "{:.3g} N.",
        frames, measure.rms, measure.rms_over_sigma, measure.largest);
  };
  add("fitted", reaction.in_fit);
  add("held-out", reaction.held_out);
  return text + " " + NoiseAndTare(reaction) + ".";
}

std::string SharesText(const std::vector<FittedParameter>& parameters) {
  std::vector<std::string> shares;
  for (const FittedParameter& parameter : parameters)
    if (parameter.share_of_forces)
      shares.push_back(
          fmt::format("{} {:.0f} %", parameter.name, 100 * *parameter.share_of_forces));
  if (shares.empty()) return "";
  return fmt::format(
      "share of the measured forces in what the data tell, the rest being that of markers or "
      "scans: "
      "{}",
      fmt::join(shares, "; "));
}

}  // namespace lacuna
