// A diagnosis as plain data.
#ifndef LACUNA_DIAGNOSIS_RECORDED_DIAGNOSIS_H_
#define LACUNA_DIAGNOSIS_RECORDED_DIAGNOSIS_H_

#include "diagnosis/diagnosis_result.h"
#include "record/diagnosis_record.h"

namespace lacuna {

// Everything that the report needs of it, the titles and the separating experiments of the effects'
// cards included.
DiagnosisRecord RecordOf(const Diagnosis& diagnosis);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_RECORDED_DIAGNOSIS_H_
