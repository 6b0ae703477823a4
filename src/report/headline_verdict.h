// What a headline (report/headline.h) says of a verdict: one or two sentences in plain words for a
// reader who does not know the method. The longer explanation, with the reasons, the probabilities
// of all hypotheses and the test of adequacy, and the parts from which both are made, such as the
// titles of effects, are in report/verdict_text.h.
#ifndef LACUNA_REPORT_HEADLINE_VERDICT_H_
#define LACUNA_REPORT_HEADLINE_VERDICT_H_

#include <string>

#include "record/diagnosis_record.h"
#include "report/reported_run.h"

namespace lacuna {

// What the model lacks, how probable that is, and what to do where the question is open. Names the
// effects that would have stayed hidden where nothing is missing, and a Young's modulus that was
// not fitted where something is. Without a diagnosis, says that there is none where the error is
// beyond the noise, and is empty otherwise.
std::string VerdictSentence(const ReportedModel& model);

// The short title of an effect or a nuisance, followed in brackets by the probability that it is
// what is missing, whatever nuisances stand beside it, but no further effect: "drag (98 %)".
// Without brackets where the record has no such hypothesis.
std::string WithProbability(const DiagnosisRecord& diagnosis, const std::string& name);

}  // namespace lacuna

#endif  // LACUNA_REPORT_HEADLINE_VERDICT_H_
