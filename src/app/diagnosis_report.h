// What a diagnosis says, in a terminal.
#ifndef LACUNA_APP_DIAGNOSIS_REPORT_H_
#define LACUNA_APP_DIAGNOSIS_REPORT_H_

#include <filesystem>

#include "diagnosis/diagnosis_record.h"

namespace lacuna {

void PrintDiagnosis(const DiagnosisRecord& diagnosis, const std::filesystem::path& run);

}  // namespace lacuna

#endif  // LACUNA_APP_DIAGNOSIS_REPORT_H_
