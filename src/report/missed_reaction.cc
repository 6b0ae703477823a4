#include "report/missed_reaction.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/quantity.h"
#include "record/comparison_record.h"
#include "record/fitted_reaction.h"

namespace lacuna {
namespace {

// The measured force or torque that is missed by the largest multiple of its noise.
struct WorstReaction {
  const FittedReaction* reaction = nullptr;
  const FittedRecording* recording = nullptr;
  const ReactionMeasure* error = nullptr;
};
WorstReaction FindWorstReaction(const CalibrationRecord& record) {
  WorstReaction worst;
  for (const FittedRecording& recording : record.recordings)
    for (const FittedReaction& reaction : recording.reactions)
      for (const ReactionMeasure* error : {&reaction.in_fit, &reaction.held_out})
        if (error->values > 0 &&
            (worst.error == nullptr || error->rms_over_sigma > worst.error->rms_over_sigma))
          worst = {&reaction, &recording, error};
  return worst;
}

// What mistakes in a reading would explain it, as halves of sentences; none is known: empty.
std::vector<std::string> LikelyMistakes(const FittedReaction& reaction) {
  const ReadingMistakes& mistakes = reaction.likely_mistakes;
  std::vector<std::string> likely;
  if (mistakes.factor && *mistakes.factor < 0)
    likely.emplace_back("with the opposite sign (`exerted_by`)");
  if (mistakes.factor && mistakes.offset)
    likely.push_back(
        fmt::format("if it were {:.3g} times the {} plus an offset of {:.3g} {}, as if the load "
                    "or the reading were in another unit",
                    *mistakes.factor, reaction.Quantity(), *mistakes.offset, reaction.Unit()));
  else if (mistakes.factor && *mistakes.factor > 0)
    likely.push_back(fmt::format("if it were {:.3g} times the {}, as in another unit",
                                 *mistakes.factor, reaction.Quantity()));
  else if (mistakes.offset)
    likely.push_back(fmt::format("with an offset of {:.3g} {} (`tare_deviation`)", *mistakes.offset,
                                 reaction.Unit()));
  if (mistakes.delay)
    likely.push_back(fmt::format("if it came {} {} (`delay_deviation`)",
                                 DurationText(std::abs(*mistakes.delay)),
                                 *mistakes.delay > 0 ? "late" : "early"));
  return likely;
}

// What a mistake in a reading may be, as the second half of a sentence.
std::string DescribeMistakes(const FittedReaction& reaction,
                             const std::vector<std::string>& likely) {
  if (!likely.empty()) return fmt::format("its reading would fit {}.", fmt::join(likely, ", or "));
  return fmt::format(
      "another sign (`exerted_by`), {}a delay (`delay_deviation`) or another unit of its reading "
      "would look like this.",
      reaction.tare_deviation == 0 ? "an offset (`tare_deviation`), " : "");
}

}  // namespace

std::string MissedReactionSentence(const ReportedModel& model) {
  // An error over the noise that is this many times that of the markers is worth a sentence.
  constexpr double kFarMore = 3;
  const auto [reaction, recording, error] = FindWorstReaction(model.calibration);
  if (error == nullptr ||
      error->rms_over_sigma < kFarMore * std::max(1.0, model.errors.rms_over_sigma))
    return "";
  std::string text = fmt::format(
      "{} it misses the {} on {}{} by {:.3g} {}, {:.1f} times its noise.",
      model.errors.rms_over_sigma < kBeyondNoise ? "But" : "And", reaction->Quantity(),
      reaction->name,
      model.calibration.recordings.size() > 1 ? fmt::format(" ({})", recording->name) : "",
      error->rms, reaction->Unit(), error->rms_over_sigma);
  if (error->rms < kConsiderableReactionError * reaction->largest_reading) return text;
  // Where an effect has been named that explains the reading, only a mistake that fits is worth a
  // doubt.
  const bool is_explained = model.diagnosis && model.diagnosis->verdict == Verdict::kMissing;
  const std::vector<std::string> likely = LikelyMistakes(*reaction);
  if (is_explained && likely.empty()) return text;
  return text + " Before an effect is looked for, the load cell should be checked: " +
         DescribeMistakes(*reaction, likely);
}

}  // namespace lacuna
