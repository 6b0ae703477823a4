// What is said about the agreement of the recordings of a fit.
#ifndef LACUNA_REPORT_AGREEMENT_TEXT_H_
#define LACUNA_REPORT_AGREEMENT_TEXT_H_

#include <string>

#include "record/agreement_record.h"

namespace lacuna {

// Whether they agree, and in which parameter and recording they differ most; empty where there are
// not two recordings to compare.
std::string ExplainAgreement(const AgreementRecord& agreement);

// The parameters of each recording side by side, for 100 columns; empty as above.
std::string AgreementTable(const AgreementRecord& agreement);

}  // namespace lacuna

#endif  // LACUNA_REPORT_AGREEMENT_TEXT_H_
