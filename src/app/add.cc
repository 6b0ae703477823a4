// lacuna add RUN EFFECT
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>

#include "app/commands.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/suggestion.h"
#include "diagnosis/diagnosis_run.h"
#include "diagnosis/extended_experiment.h"
#include "effects/catalogue.h"
#include "prediction/prediction_study_reader.h"
#include "report/calibration_report.h"

namespace lacuna {
namespace {

[[noreturn]] void Refuse(const std::string& type, const std::string& why) {
  throw InputError(fmt::format(
      "{} cannot be added by itself: {}; write it into the experiment's `effects`", type, why));
}

// What can be told before the computation.
void RequireAddable(const std::string& type, const PredictionStudy& study) {
  std::vector<std::string> known;
  for (const OwnLaw& law : study.candidates) known.push_back(law.name);
  if (std::count(known.begin(), known.end(), type) > 0) return;
  const CatalogueEntry* entry = FindEntry(type);
  if (entry == nullptr) {
    for (const CatalogueEntry& other : Catalogue()) known.push_back(other.card->type);
    throw InputError(fmt::format("no effect is called \"{}\"{}; `lacuna effects` lists them", type,
                                 Suggestion(type, known)));
  }
  const bool is_there =
      std::any_of(study.effects.begin(), study.effects.end(),
                  [&](const auto& effect) { return effect->Card().type == type; });
  if (is_there && !entry->card->repeatable)
    throw InputError(fmt::format("{}: the model has it already", type));
  if (entry->make == nullptr)
    throw InputError(fmt::format(
        "{} is not one effect: write a law of your own into the experiment's `candidates`, and add "
        "it by its name (docs/expression.md)",
        type));
}

const ScoredEffect& FindScored(const EffectRanking& ranking, const std::string& type) {
  for (const ScoredEffect& effect : ranking.effects)
    if (effect.candidate.type == type) return effect;
  for (const UntriedEffect& effect : ranking.untried)
    if (effect.type == type) Refuse(type, effect.why);
  Refuse(type, "its size has no null value");
}

int RunAdd(const std::filesystem::path& run, const std::string& type) {
  const FittedRun fitted = OpenRun(run);
  RequireAddable(type, fitted.study);
  // One that cannot be written into is told before the computation, too.
  MakeFolder(std::filesystem::absolute(run / "..").lexically_normal());
  Progress progress;
  std::optional<ScoredEffect> diagnosed = FindDiagnosed(fitted, run, type);
  if (!diagnosed) {
    const CalibrationProblem problem(fitted.study, fitted.mesh);
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
  fmt::print("\nbefore\n{}", CalibrationReport(fitted.record));
  fmt::print("\nwith {}\n{}", type, CalibrationReport(record));
  if (!record.usable) fmt::print("\nThe fit did not converge: {}\n", record.message);
  fmt::print("\nThe experiment is {}\nThe run lies in {}\n", file.string(), study.output.string());
  return record.usable ? 0 : 1;
}

}  // namespace

void AddAdd(CLI::App* app, std::function<int()>* command) {
  CLI::App* add = app->add_subcommand("add", "A fitted model with one more effect, fitted again");
  add->footer(
      "Writes an experiment, NAME+EFFECT.yaml for one called NAME, beside RUN, which starts from\n"
      "RUN's fitted values, and runs it: errors before and after, on fitted and on held-out\n"
      "frames. EFFECT is of the catalogue or a law of your own among the experiment's\n"
      "`candidates`. An elasticity law takes the\n"
      "place of the model's.");
  auto run = std::make_shared<std::string>();
  auto effect = std::make_shared<std::string>();
  add->add_option("run", *run, "The folder of a finished `lacuna fit`")->required();
  add->add_option("effect", *effect, "Its name; `lacuna effects` lists the catalogue's")
      ->required();
  add->callback(
      [command, run, effect] { *command = [run, effect] { return RunAdd(*run, *effect); }; });
}

}  // namespace lacuna
