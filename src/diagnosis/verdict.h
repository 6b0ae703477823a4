// The verdict of a diagnosis in terms that a user acts upon, from its decision.
#ifndef LACUNA_DIAGNOSIS_VERDICT_H_
#define LACUNA_DIAGNOSIS_VERDICT_H_

#include "diagnosis/decision.h"
#include "diagnosis/diagnosis_result.h"

namespace lacuna {

// Sets the conclusion: the verdict with the names, the reasons, and what would settle an open
// question. Pure: the result depends on the arguments alone.
void Conclude(const Decision& decision, Diagnosis* diagnosis);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_VERDICT_H_
