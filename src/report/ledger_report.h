// The report of a ledger of models, made from its record alone. It is written to ledger.txt.
#ifndef LACUNA_REPORT_LEDGER_REPORT_H_
#define LACUNA_REPORT_LEDGER_REPORT_H_

#include <string>

#include "record/ledger.h"

namespace lacuna {

// The tree of models with their errors, verdicts and moved parameters, why the search ended, and
// the error before and after, for 100 columns. At least one model is needed (CHECK).
std::string LedgerReport(const Ledger& ledger);

// Why the search ended, and the error before and after: the last lines of the report. At least one
// model is needed (CHECK).
std::string LedgerSummary(const Ledger& ledger);

// Why no further effect was added, in one or two sentences. Empty while the search continues.
std::string DescribeEnding(const Ledger& ledger);

}  // namespace lacuna

#endif  // LACUNA_REPORT_LEDGER_REPORT_H_
