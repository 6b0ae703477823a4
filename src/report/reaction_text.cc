#include "report/reaction_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace lacuna {
namespace {

std::string Describe(const ReactionMeasure& measure, const std::string& unit) {
  if (measure.values == 0) return "-";
  return fmt::format("{:.3g} {} (largest {:.3g}), {:.1f} σ, {} frames", measure.rms, unit,
                     measure.largest, measure.rms_over_sigma, measure.frames);
}

std::string NoiseAndTare(const FittedReaction& reaction) {
  std::string text =
      fmt::format("σ = {:.3g} {}{}", reaction.deviation, reaction.Unit(),
                  reaction.deviation_is_estimated ? ", estimated from the reading" : "");
  if (reaction.tare_deviation > 0)
    text += fmt::format("; tare {:.3g} {} (prior ± {:.3g} {})", fmt::join(reaction.tare, ", "),
                        reaction.Unit(), reaction.tare_deviation, reaction.Unit());
  if (reaction.is_opposite)
    text += fmt::format("; the reading is that of the opposite {}", reaction.Quantity());
  return text;
}

}  // namespace

std::string ReactionLines(const FittedReaction& reaction) {
  return fmt::format("  {:14} fitted    {}\n  {:14} held out  {}\n  {:14} {}\n",
                     fmt::format("{} on {}", reaction.Quantity(), reaction.name),
                     Describe(reaction.in_fit, reaction.Unit()), "",
                     Describe(reaction.held_out, reaction.Unit()), "", NoiseAndTare(reaction));
}

std::string DescribeReactionFit(const FittedReaction& reaction, const std::string& recording) {
  std::string text = fmt::format(
      "{}, {} on {} ({}; the largest reading is {:.3g} {}):", recording, reaction.Quantity(),
      reaction.name, fmt::join(reaction.labels, ", "), reaction.largest_reading, reaction.Unit());
  const auto add = [&](const char* frames, const ReactionMeasure& measure) {
    if (measure.values == 0) return;
    text += fmt::format(
        " in the {} frames the rms error of a component is {:.3g} {}, {:.1f} σ, and the largest "
        "{:.3g} {}.",
        frames, measure.rms, reaction.Unit(), measure.rms_over_sigma, measure.largest,
        reaction.Unit());
  };
  add("fitted", reaction.in_fit);
  add("held-out", reaction.held_out);
  return text + " " + NoiseAndTare(reaction) + ".";
}

}  // namespace lacuna
