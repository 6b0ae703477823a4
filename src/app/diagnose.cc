// lacuna diagnose RUN
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "app/commands.h"
#include "core/atomic_file.h"
#include "study/calibration_run.h"
#include "study/diagnosis.h"

namespace lacuna {
namespace {

std::string Sizes(const ScoredEffect& effect) {
  std::vector<std::string> sizes;
  for (size_t k = 0; k < effect.parameters.size(); ++k) {
    const Eigen::Index at = static_cast<Eigen::Index>(k);
    sizes.push_back(
        fmt::format("{:.3g} ± {:.2g}", effect.score.size[at], effect.score.deviation[at]));
  }
  return fmt::format("{} {}", fmt::join(sizes, ", "), effect.units.front());
}

void PrintRanking(const Diagnosis& diagnosis) {
  fmt::print("\n  {:22} {:>9} {:>10} {:>9}  {:34} {}\n", "effect", "evidence", "explains",
             "absorbed", "expected size", "refit: evidence; held-out error");
  constexpr size_t kShown = 12;
  for (size_t k = 0; k < std::min(kShown, diagnosis.ranking.size()); ++k) {
    const RankedEffect& effect = diagnosis.ranking[k];
    std::string refit = "-";
    if (effect.refitted)
      refit = effect.refit_message.empty()
                  ? fmt::format("{:.1f}; {:.3f} mm, {:.1f} σ", effect.evidence,
                                1e3 * effect.errors.held_out_rms, effect.errors.in_noise)
                  : effect.refit_message;
    fmt::print("  {:22} {:>9.1f} {:>9.0f}% {:>8.0f}%  {:34} {}\n", effect.scored.candidate.type,
               effect.scored.score.evidence, 100 * effect.scored.score.explained,
               100 * effect.scored.score.absorbed, Sizes(effect.scored), refit);
    if (!effect.scored.candidate.variant.empty())
      fmt::print("      {}\n", effect.scored.candidate.variant);
  }
}

void PrintVerdict(const Diagnosis& diagnosis) {
  fmt::print("\n  {:22} {:>9} {:>10}\n", "nuisance", "evidence", "explains");
  for (const ScoredNuisance& nuisance : diagnosis.nuisances)
    fmt::print("  {:22} {:>9.1f} {:>9.0f}%{}\n", nuisance.candidate.name, nuisance.evidence,
               100 * nuisance.explained, nuisance.adopted ? "  taken into the model" : "");
  fmt::print(
      "\n{}{}\n  {}\n", VerdictName(diagnosis.verdict),
      diagnosis.effects.empty() ? "" : fmt::format(" {{{}}}", fmt::join(diagnosis.effects, ", ")),
      diagnosis.explanation);
  if (!diagnosis.experiment.empty()) fmt::print("  what would tell: {}\n", diagnosis.experiment);
}

int RunDiagnose(const std::filesystem::path& run, int refits) {
  const FittedRun opened = OpenRun(run);
  const CalibrationProblem problem(opened.study, opened.mesh);
  Progress progress;
  const Diagnosis diagnosis =
      Diagnose(problem, opened.values, {.refits = refits}, &progress);
  const std::filesystem::path folder = run / "diagnosis";
  MakeFolder(folder);
  SaveDiagnosis(diagnosis, folder / "diagnosis.json");
  PrintRanking(diagnosis);
  PrintVerdict(diagnosis);
  fmt::print("\n{} holds all of it\n", (folder / "diagnosis.json").string());
  return 0;
}

}  // namespace

void AddDiagnose(CLI::App* app, std::function<int()>* command) {
  CLI::App* diagnose =
      app->add_subcommand("diagnose", "Which physical effect a fitted model lacks");
  diagnose->footer(
      "RUN is the folder of a finished `lacuna fit`. Every effect of the catalogue is scored "
      "along\n"
      "the fitted motion; the best are fitted, and judged by frames and recordings held out.");
  auto run = std::make_shared<std::string>();
  auto refits = std::make_shared<int>(3);
  diagnose->add_option("run", *run, "The run's folder")->required();
  diagnose->add_option("--refits", *refits, "How many effects to fit")->check(CLI::Range(0, 50));
  diagnose->callback(
      [command, run, refits] { *command = [run, refits] { return RunDiagnose(*run, *refits); }; });
}

}  // namespace lacuna
