#include "diagnosis/extension_rounds.h"

#include <fmt/format.h>

#include <optional>

#include "calibration/calibration_run.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "diagnosis/diagnosis_run.h"
#include "diagnosis/extended_experiment.h"
#include "prediction/prediction_study_reader.h"
#include "report/ledger_report.h"

namespace lacuna {
namespace {

// Whether the verdict ends the search: kNone where an effect is to be added.
LedgerEnding::Reason EndingOf(const DiagnosisRecord& diagnosis, const ExtensionOptions& options,
                              int added) {
  using Reason = LedgerEnding::Reason;
  const bool is_ambiguous = diagnosis.verdict == Verdict::kAmbiguous;
  if (is_ambiguous && !options.follow_best) return Reason::kUndecided;
  if (!is_ambiguous && diagnosis.verdict != Verdict::kMissing && !PartlyExplainedBy(diagnosis))
    return Reason::kVerdict;
  return added == options.most_effects ? Reason::kMostEffects : Reason::kNone;
}

// The effect that is to be added: the one that explains most, or that the verdict names first.
const RecordedEffect& ToAdd(const DiagnosisRecord& diagnosis, const std::filesystem::path& run) {
  const std::optional<std::string> part = PartlyExplainedBy(diagnosis);
  const std::string name = part ? *part : diagnosis.effects.front();
  for (const RecordedEffect& effect : diagnosis.ranking)
    if (effect.type == name) return effect;
  throw InputError(
      fmt::format("{}: its diagnosis names {}, which it does not rank", run.string(), name));
}

}  // namespace

Ledger ExtendUntilDone(const std::filesystem::path& run, const ExtensionOptions& options,
                       Progress* progress, const std::function<void(const Ledger&)>& on_change) {
  Ledger ledger;
  const auto keep = [&] {
    WriteLedgerFile(ledger, run);
    WriteFileAtomically(run / "ledger.txt", LedgerReport(ledger));
    on_change(ledger);
  };
  std::filesystem::path at = run;
  FittedRun fitted = OpenRun(run);
  ledger.models.push_back(MakeLedgerModel(ledger, run, fitted.record, -1, ""));
  for (int added = 0; !ledger.HasEnded(); ++added) {
    const int parent = static_cast<int>(ledger.models.size()) - 1;
    const DiagnosisRecord diagnosis = RunDiagnosis(fitted, at, options.diagnosis, progress);
    ledger.models.back().diagnosis = diagnosis;
    ledger.ending.reason = EndingOf(diagnosis, options, added);
    keep();
    if (ledger.HasEnded()) break;

    const RecordedEffect& effect = ToAdd(diagnosis, at);
    const std::filesystem::path file =
        WriteExtendedExperiment(fitted, at, DiagnosedEffect(fitted, at, effect));
    const PredictionStudy study = ReadPredictionStudy(Config::Load(file));
    const CalibrationRecord record = RunCalibration(study, progress);
    at = study.output;
    ledger.models.push_back(MakeLedgerModel(ledger, at, record, parent, effect.type));
    if (!record.usable) {
      ledger.ending.reason = LedgerEnding::Reason::kNotFitted;
    } else if (!LowersError(ledger.models.back(), options.least_gain)) {
      ledger.ending = {LedgerEnding::Reason::kLittleGain, options.least_gain};
    } else if (ledger.models.back().may_be_zero) {
      ledger.ending.reason = LedgerEnding::Reason::kMayBeZero;
    }
    keep();
    if (!ledger.HasEnded()) fitted = OpenRun(at);
  }
  return ledger;
}

}  // namespace lacuna
