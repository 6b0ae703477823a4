// lacuna add RUN EFFECT
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>

#include "app/commands.h"
#include "app/fit_report.h"
#include "core/error.h"
#include "core/suggestion.h"
#include "effects/catalogue.h"
#include "study/candidates.h"
#include "study/diagnosis_run.h"
#include "study/extended_experiment.h"

namespace lacuna {
namespace {

const ScoredEffect& FindScored(const EffectRanking& ranking, const std::string& type) {
  std::vector<std::string> known;
  for (const ScoredEffect& effect : ranking.effects) {
    if (effect.candidate.type == type) return effect;
    known.push_back(effect.candidate.type);
  }
  for (const UntriedEffect& effect : ranking.untried)
    if (effect.type == type)
      throw InputError(
          fmt::format("{} cannot be added by itself: {}; write it into the experiment's `effects`",
                      type, effect.why));
  if (FindEntry(type) == nullptr) {
    throw InputError(fmt::format("no effect is called \"{}\"{}; `lacuna effects` lists them", type,
                                 Suggestion(type, known)));
  }
  throw InputError(
      fmt::format("{} cannot be added by itself: the model has it already, or its size has no null "
                  "value; write "
                  "it into the experiment's `effects`",
                  type));
}

// An effect that the model has, and could not have twice, is told before the computation.
void RequireRoomFor(const std::string& type, const CalibrationProblem& problem) {
  const PredictionStudy& study = problem.study();
  const bool is_there =
      std::any_of(study.effects.begin(), study.effects.end(),
                  [&](const auto& effect) { return effect->Card().type == type; });
  if (!is_there) return;
  const std::vector<CandidateEffect> candidates =
      MakeCandidates({*problem.body(), study.effects, study.time_step, Duration(study), {}});
  if (std::none_of(candidates.begin(), candidates.end(),
                   [&](const CandidateEffect& candidate) { return candidate.type == type; }))
    FindScored({}, type);
}

int RunAdd(const std::filesystem::path& run, const std::string& type) {
  const FittedRun fitted = OpenRun(run);
  if (FindEntry(type) == nullptr) FindScored({}, type);  // told before the computation
  Progress progress;
  std::optional<ScoredEffect> diagnosed = FindDiagnosed(run, type);
  if (!diagnosed) {
    const CalibrationProblem problem(fitted.study, fitted.mesh);
    RequireRoomFor(type, problem);
    diagnosed = FindScored(RankEffects(problem, fitted.values, &progress), type);
  }
  const ScoredEffect& effect = *diagnosed;
  const std::string unseen = WhyUnseen(effect);
  if (!unseen.empty())
    throw InputError(
        fmt::format("{}: {}; to fit it all the same, write it into the experiment's `effects`",
                    run.string(), unseen));
  const std::filesystem::path file = WriteExtendedExperiment(fitted, run, effect);
  const PredictionStudy study = ReadPredictionStudy(Config::Load(file));
  const CalibrationRecord record = RunCalibration(study, &progress);
  fmt::print("\nbefore\n");
  PrintCalibration(fitted.record);
  fmt::print("\nwith {}\n", type);
  PrintCalibration(record);
  if (!record.usable) fmt::print("\nThe fit did not converge: {}\n", record.message);
  fmt::print("\nThe experiment is {}\nThe run lies in {}\n", file.string(), study.output.string());
  return record.usable ? 0 : 1;
}

}  // namespace

void AddAdd(CLI::App* app, std::function<int()>* command) {
  CLI::App* add = app->add_subcommand("add", "A fitted model with one more effect, fitted again");
  add->footer(
      "Writes the experiment RUN+EFFECT.yaml beside RUN, which starts from RUN's fitted values, "
      "and\n"
      "runs it: errors before and after, on fitted and on held-out frames. An elasticity law takes "
      "the\n"
      "place of the model's.");
  auto run = std::make_shared<std::string>();
  auto effect = std::make_shared<std::string>();
  add->add_option("run", *run, "The folder of a finished `lacuna fit`")->required();
  add->add_option("effect", *effect, "Its name; `lacuna effects` lists them")->required();
  add->callback(
      [command, run, effect] { *command = [run, effect] { return RunAdd(*run, *effect); }; });
}

}  // namespace lacuna
