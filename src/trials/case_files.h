// The files in the folder of a sealed case, and the work on the cases of a suite.
#ifndef LACUNA_TRIALS_CASE_FILES_H_
#define LACUNA_TRIALS_CASE_FILES_H_

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

#include "core/workers.h"

namespace lacuna {

inline constexpr char kTruthFile[] = "truth.json";  // a TrialCase
inline constexpr char kExperimentFile[] = "experiment.yaml";
inline constexpr char kWithoutFile[] = "without.txt";  // types of removed effects, one in each line
// The record of a diagnosis, and the folder of what it was decided from
// (diagnosis/decision_store.h).
inline constexpr char kDiagnosisFile[] = "diagnosis.json";
inline constexpr char kDecisionFolder[] = "decision";
inline constexpr char kOutcomeFile[] = "outcome.json";  // a TrialOutcome, written last
inline constexpr char kClaimFile[] = "claimed";         // the lock of a process that works here
inline constexpr char kFailureFile[] = "failed.txt";    // why there is no result
inline constexpr char kSkippedFile[] = "skipped.txt";  // why the case was abandoned before it had a
                                                       // truth

// The folders of the cases of a suite, those with a truth, sorted by name. Throws InputError if the
// suite has no folder.
std::vector<std::filesystem::path> CasesIn(const std::filesystem::path& folder);

// The folders of the cases of a suite that MakeCase (trials/trial_suite.h) has abandoned, sorted by
// name. Throws InputError if the suite has no folder.
std::vector<std::filesystem::path> SkippedCasesIn(const std::filesystem::path& folder);

// The order in which ShareCases takes the cases, indices into `cases`: that of the hashes of their
// names, which has nothing to do with what was hidden in them. Hence the first results of
// a suite that is stopped early are a fair sample of all.
std::vector<size_t> WorkOrder(const std::vector<std::filesystem::path>& cases);

// Calls job(k) for each case in WorkOrder, in processes as `options` says, unless another call
// works on it: the lock (core/claim.h) is in the folder `of_lock` of the case, which is made.
// Returns the result of RunInProcesses (core/workers.h).
bool ShareCases(const std::vector<std::filesystem::path>& cases,
                const std::filesystem::path& of_lock, const WorkerOptions& options,
                const std::function<void(size_t k)>& job);

// For each case k whose folder has no file `result` yet, a path relative to it, calls job(k), which
// makes it, by ShareCases with the lock beside the result, `workers` at a time. If the job throws
// InputError or its process crashes, failed.txt beside the result has the reason until a later call
// has made the result. Returns the result of ShareCases, for which an InputError is no failure.
bool WorkOn(const std::vector<std::filesystem::path>& cases, const std::filesystem::path& result,
            int workers, const std::function<void(size_t k)>& job);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_CASE_FILES_H_
