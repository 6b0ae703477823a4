// A finished run of `lacuna fit` with everything that its folder keeps, opened for a report.
#ifndef LACUNA_REPORT_REPORTED_RUN_H_
#define LACUNA_REPORT_REPORTED_RUN_H_

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "record/calibration_record.h"
#include "record/comparison_record.h"
#include "record/diagnosis_record.h"
#include "record/manifest.h"
#include "record/model_errors.h"

namespace lacuna {

// One fitted model. A comparison or a diagnosis of an earlier fit in the same folder is left out,
// and so is a plan that was made from another diagnosis.
struct ReportedModel {
  std::filesystem::path folder;
  std::string name;   // of the folder
  std::string added;  // the effect that the model before it lacks; empty: none
  std::string fit;    // hash of calibration.json
  CalibrationRecord calibration;
  ModelErrors errors;  // 0 if the fit is not usable
  std::optional<ComparisonRecord> comparison;
  std::optional<DiagnosisRecord> diagnosis;
  bool has_plan = false;  // plan/plan.json was made from this diagnosis
};

struct ReportedRun {
  std::vector<ReportedModel> models;  // at least one; each has one effect more than the one before
  nlohmann::json ledger;              // ledger.json; null where there is none
  std::vector<std::string> notes;     // what was left out, and why

  // The model whose folder was opened: the first one of a ledger, which lies in its folder, and
  // otherwise the last one.
  const ReportedModel& Opened() const { return ledger.is_null() ? models.back() : models.front(); }
};

// Opens the run with the models that belong to it: those of its ledger, or, for a run NAME+EFFECT
// that `lacuna add` has made, the models that it was made from, as far as their folders lie beside
// it. The run NAME is taken for such a model only if it lacks EFFECT, which NAME+EFFECT has, and if
// both were fitted to the same frames of the same recordings.
// Nothing is computed. Throws InputError when the folder is no finished run of `lacuna fit`, or
// when one of its files is damaged.
ReportedRun OpenReportedRun(const std::filesystem::path& folder);

// The name of a run: the last part of the path of its folder, which need not exist. "." has the
// name of the working directory, and a slash at the end changes nothing.
std::string RunName(const std::filesystem::path& folder);

// Whether the folder holds a finished run of `lacuna fit`.
bool IsFittedRun(const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_REPORT_REPORTED_RUN_H_
