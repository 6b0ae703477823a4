// lacuna diagnose RUN
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"
#include "core/text_layout.h"
#include "diagnosis/diagnosis_run.h"
#include "diagnosis/extension_rounds.h"
#include "prediction/recorded_motion.h"
#include "report/agreement_text.h"
#include "report/diagnosis_report.h"
#include "report/ledger_picture.h"
#include "report/ledger_report.h"
#include "report/verdict_text.h"

namespace lacuna {
namespace {

struct DiagnoseArguments {
  std::string run;
  int refits = DiagnosisOptions{}.refits;
  bool until_done = false, follow_best = false;
  int most_effects = ExtensionOptions{}.most_effects;
};

// One line about the model that was just fitted or diagnosed.
void PrintStep(const Ledger& ledger) {
  const LedgerModel& model = ledger.models.back();
  if (model.diagnosis) {
    fmt::print("{}: {}\n", model.name, VerdictWithNames(*model.diagnosis));
  } else if (model.record.usable) {
    fmt::print("{}: {:.3f} mm, {:.1f} σ\n", model.name, 1e3 * model.errors.held_out_rms,
               model.errors.rms_over_sigma);
  }
  (void)fflush(stdout);
}

int RunUntilDone(const DiagnoseArguments& arguments, const OutputOptions& output) {
  ExtensionOptions options;
  options.diagnosis.refits = arguments.refits;
  options.follow_best = arguments.follow_best;
  options.most_effects = arguments.most_effects;
  Progress progress(output.ForProgress());
  const Ledger ledger =
      ExtendUntilDone(arguments.run, options, &progress, [&](const Ledger& changed) {
        if (output.PrintsText()) PrintStep(changed);
      });
  if (output.json) PrintRecord(std::filesystem::path(arguments.run) / "ledger.json");
  if (output.PrintsText() && !output.verbose) fmt::print("\n{}", LedgerSummary(ledger));
  if (output.PrintsText() && output.verbose)
    fmt::print("\n{}\nThis report was written to {}, and all numbers to ledger.json\n",
               LedgerReport(ledger),
               (std::filesystem::path(arguments.run) / "ledger.txt").string());
  const std::filesystem::path picture = std::filesystem::path(arguments.run) / "ledger.png";
  const PictureResult drawn = RenderLedgerPng(picture, PictureOf(ledger));
  if (output.PrintsText() && (output.verbose || !drawn.IsUsable()))
    fmt::print("{}\n", drawn.IsUsable() ? picture.string() + " shows these errors as a picture"
                                        : drawn.message);
  WriteFitReport(output, arguments.run, &progress);
  return ledger.IsUsable() ? 0 : 1;
}

int RunDiagnose(const DiagnoseArguments& arguments, const OutputOptions& output) {
  if (arguments.until_done) return RunUntilDone(arguments, output);
  const FittedRun fitted = OpenRun(arguments.run);
  const std::string warning = RestWarning(fitted.study);
  if (!warning.empty()) PrintWarnings(output, {warning});
  DiagnosisOptions options;
  options.refits = arguments.refits;
  Progress progress(output.ForProgress());
  const DiagnosisRecord diagnosis = RunDiagnosis(fitted, arguments.run, options, &progress);
  const std::filesystem::path run = arguments.run;
  if (output.json) PrintRecord(run / "diagnosis/diagnosis.json");
  if (output.PrintsText())
    fmt::print("{}", output.verbose ? DiagnosisReport(diagnosis, fitted.record, run)
                                    : VerdictWithNames(diagnosis) + "\n");
  // Where they disagree, the headline of the report says so.
  const std::string agreement = ExplainAgreement(diagnosis.agreement);
  if (output.PrintsText() && !output.verbose && !diagnosis.agreement.Disagree() &&
      !agreement.empty())
    fmt::print("{}", Wrapped(agreement, "", ""));
  WriteFitReport(output, run, &progress);
  return 0;
}

}  // namespace

void AddDiagnose(CLI::App* app, OutputOptions* output, std::function<int()>* command) {
  CLI::App* diagnose =
      app->add_subcommand("diagnose", "Find the physical effect that a fitted model lacks");
  diagnose->footer(
      "RUN is the folder of a finished `lacuna fit`. Every effect of the catalogue is scored by\n"
      "linearisation along the fitted motion; the best are fitted and compared by their evidence,\n"
      "which counts the held-out frames too. With --until-done, the missing effect is added and\n"
      "the new model is diagnosed in turn, until no effect can be named any more; RUN/ledger.txt\n"
      "lists what was tried and how much it reduced the error. The same command resumes an\n"
      "interrupted run.");
  auto arguments = std::make_shared<DiagnoseArguments>();
  diagnose->add_option("run", arguments->run, "Folder of the run")->required();
  diagnose->add_option("--refits", arguments->refits, "How many of the best effects to fit")
      ->check(CLI::Range(1, 50));
  CLI::Option* until_done =
      diagnose->add_flag("--until-done", arguments->until_done,
                         "Add the missing effect, fit, diagnose again, and so on");
  diagnose
      ->add_flag("--follow-best", arguments->follow_best,
                 "Where the verdict is ambiguous, add the best effect instead of stopping")
      ->needs(until_done);
  diagnose->add_option("--most", arguments->most_effects, "Largest number of effects to add")
      ->check(CLI::Range(0, 50))
      ->needs(until_done);
  AddOutputOptions(diagnose, output);
  diagnose->callback([=] { *command = [=] { return RunDiagnose(*arguments, *output); }; });
}

}  // namespace lacuna
