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
#include "diagnosis/rank_effects.h"
#include "effects/catalogue.h"
#include "prediction/prediction_study_reader.h"
#include "report/calibration_report.h"

namespace lacuna {
namespace {

[[noreturn]] void Refuse(const std::string& type, const std::string& why) {
  throw InputError(fmt::format(
      "{} cannot be added automatically: {}; write it into the experiment's `effects`", type, why));
}

// Checks what can be checked before the computation. Throws InputError.
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
    throw InputError(fmt::format("{}: the model already has this effect", type));
  for (const auto& effect : study.effects)
    if (effect->Card().type != type && !MayStandBeside(effect->Card(), *entry->card))
      throw InputError(fmt::format("{}: cannot be combined with {}, which the model has", type,
                                   effect->Card().type));
  if (entry->is_own_law)
    throw InputError(fmt::format(
        "{} stands for any user-defined law: write the law into the experiment's `candidates`, and "
        "add it by its name (docs/expression.md)",
        type));
  if (entry->make == nullptr) Refuse(type, "a part of it is an expression, which you choose");
}

const ScoredEffect& FindScored(const EffectRanking& ranking, const std::string& type) {
  for (const ScoredEffect& effect : ranking.effects)
    if (effect.candidate.type == type) return effect;
  for (const UntriedEffect& effect : ranking.untried)
    if (effect.type == type) Refuse(type, effect.why);
  Refuse(type, "none of its parameters has a value at which it vanishes");
}

int RunAdd(const std::filesystem::path& run, const std::string& type, const OutputOptions& output) {
  const FittedRun fitted = OpenRun(run);
  RequireAddable(type, fitted.study);
  // A folder that cannot be written to is reported before the computation, too.
  MakeFolder(std::filesystem::absolute(run / "..").lexically_normal());
  Progress progress(output.ForProgress());
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
  if (output.json) PrintRecord(study.output / "calibration/calibration.json");
  if (output.PrintsText()) {
    const auto text = output.verbose ? CalibrationReport : CalibrationSummary;
    if (output.verbose) fmt::print("\nbefore\n{}", text(fitted.record));
    fmt::print("\nwith {}\n{}", type, text(record));
    if (!record.message.empty()) fmt::print("\nThe fit did not converge: {}\n", record.message);
    fmt::print("\nThe experiment was written to {}\nThe run was written to {}\n", file.string(),
               study.output.string());
  }
  WriteFitReport(output, study.output, &progress);
  return record.usable ? 0 : 1;
}

}  // namespace

void AddAdd(CLI::App* app, OutputOptions* output, std::function<int()>* command) {
  CLI::App* add = app->add_subcommand("add", "Add one effect to a fitted model and fit it again");
  add->footer(
      "Writes the experiment NAME+EFFECT.yaml beside RUN, where NAME is the name of RUN's\n"
      "experiment, and fits it, starting from RUN's fitted values. The errors before and after\n"
      "are reported for the fitted and for the held-out frames. EFFECT is an effect of the\n"
      "catalogue or a user-defined law from the experiment's `candidates`. An elasticity law\n"
      "replaces that of the model.");
  auto run = std::make_shared<std::string>();
  auto effect = std::make_shared<std::string>();
  add->add_option("run", *run, "Folder of a finished `lacuna fit`")->required();
  add->add_option("effect", *effect,
                  "Name of the effect; `lacuna effects` lists those of the catalogue")
      ->required();
  AddOutputOptions(add, output);
  add->callback([=] { *command = [=] { return RunAdd(*run, *effect, *output); }; });
}

}  // namespace lacuna
