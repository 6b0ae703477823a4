#include "diagnosis/extension_rounds.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "calibration/calibration_run.h"
#include "core/error.h"
#include "diagnosis/diagnosis_run.h"
#include "diagnosis/extended_experiment.h"
#include "prediction/prediction_study_reader.h"

namespace lacuna {
namespace {

// Why the verdict ends the search; empty: its first effect is to be added.
std::string EndingOf(const DiagnosisRecord& diagnosis, const ExtensionOptions& options) {
  if (diagnosis.verdict == "missing") return "";
  if (diagnosis.verdict == "ambiguous") {
    if (options.follow_best) return "";
    return fmt::format(
        "It ends undecided between {{{}}}, of which none is added by guess{}. --follow-best would "
        "go on with the first.",
        fmt::join(diagnosis.effects, ", "),
        diagnosis.experiment.empty() ? "" : "; what would tell: " + diagnosis.experiment);
  }
  return fmt::format("It ends with the verdict \"{}\".", VerdictWithNames(diagnosis));
}

const RecordedEffect& Named(const DiagnosisRecord& diagnosis, const std::filesystem::path& run) {
  for (const RecordedEffect& effect : diagnosis.ranking)
    if (effect.type == diagnosis.effects.front()) return effect;
  throw InputError(fmt::format("{}: its diagnosis names {}, which it does not rank", run.string(),
                               diagnosis.effects.front()));
}

}  // namespace

Ledger ExtendUntilDone(const std::filesystem::path& run, const ExtensionOptions& options,
                       Progress* progress, const std::function<void(const Ledger&)>& on_change) {
  Ledger ledger;
  const auto keep = [&] {
    SaveLedger(ledger, run);
    on_change(ledger);
  };
  std::filesystem::path at = run;
  FittedRun fitted = OpenRun(run);
  ledger.models.push_back(MakeLedgerModel(ledger, run, fitted.record, -1, ""));
  for (int added = 0; ledger.ending.empty(); ++added) {
    const int parent = static_cast<int>(ledger.models.size()) - 1;
    const DiagnosisRecord diagnosis = RunDiagnosis(fitted, at, options.diagnosis, progress);
    ledger.models.back().diagnosis = diagnosis;
    ledger.ending = EndingOf(diagnosis, options);
    if (ledger.ending.empty() && added == options.most_effects)
      ledger.ending = fmt::format("It ends after {} added effects, though {} is named still.",
                                  added, diagnosis.effects.front());
    keep();
    if (!ledger.ending.empty()) break;

    const std::string effect = diagnosis.effects.front();
    const std::filesystem::path file =
        WriteExtendedExperiment(fitted, at, DiagnosedEffect(fitted, at, Named(diagnosis, at)));
    const PredictionStudy study = ReadPredictionStudy(Config::Load(file));
    const CalibrationRecord record = RunCalibration(study, progress);
    at = study.output;
    ledger.models.push_back(MakeLedgerModel(ledger, at, record, parent, effect));
    const LedgerModel& model = ledger.models.back();
    if (!record.usable) {
      ledger.usable = false;
      ledger.ending =
          fmt::format("It ends because {} cannot be fitted: {}.", effect, record.message);
    } else if (model.gain < options.least_gain) {
      ledger.ending =
          fmt::format("It ends because {} takes away {:.1f} % of the {} error, less than {:g} %.",
                      effect, 100 * model.gain, model.errors.has_held_out ? "held-out" : "fitted",
                      100 * options.least_gain);
    }
    keep();
    if (ledger.ending.empty()) fitted = OpenRun(at);
  }
  return ledger;
}

}  // namespace lacuna
