// The part of a report's document for a study of many runs: Table 1, its ablation, sealed cases,
// intervals.
#ifndef LACUNA_REPORT_STUDY_DOCUMENT_H_
#define LACUNA_REPORT_STUDY_DOCUMENT_H_

#include <filesystem>

#include "report/gathered_run.h"

namespace lacuna {

// Whether the folder has the results of such a study. Throws InputError where one of them is
// damaged.
bool IsStudy(const std::filesystem::path& folder);

// Throws InputError where a file is damaged.
GatheredRun GatherStudy(const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_REPORT_STUDY_DOCUMENT_H_
