// The part of a report's document for a run of `lacuna fit`.
#ifndef LACUNA_REPORT_FIT_DOCUMENT_H_
#define LACUNA_REPORT_FIT_DOCUMENT_H_

#include <filesystem>

#include "report/gathered_run.h"

namespace lacuna {

// The run with the models that belong to it (OpenReportedRun). Throws InputError where a file is
// damaged.
GatheredRun GatherFit(const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_REPORT_FIT_DOCUMENT_H_
