// The explanation of a verdict in whole sentences for a reader who knows the method, and the parts
// that all texts about a verdict share, such as the titles of effects. Made from the recorded
// diagnosis alone. The plain sentence that a headline says instead: report/headline_verdict.h.
#ifndef LACUNA_REPORT_VERDICT_TEXT_H_
#define LACUNA_REPORT_VERDICT_TEXT_H_

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "record/diagnosis_record.h"

namespace lacuna {

// The verdict with the names it gives, e.g. "ambiguous {drag, mass_damping}".
std::string VerdictWithNames(const Conclusion& conclusion);

// The nuisance that a name alone means: of those that several recordings or grips have, the one
// with the most evidence. Null: there is none.
const RecordedNuisance* StrongestNuisance(const DiagnosisRecord& diagnosis,
                                          const std::string& name);

// The title of an effect, what a nuisance is, or the name itself where the record has neither.
std::string TitleOf(const DiagnosisRecord& diagnosis, const std::string& name);

// The title within a sentence, without what it has in brackets: "Viscoelastic branch (Maxwell
// element of a Prony series)" as "viscoelastic branch".
std::string ShortTitle(const DiagnosisRecord& diagnosis, const std::string& name);

// What the model at `index` of a sequence is called beside the others: "initial model", "with
// viscoelastic branch" for the first added effect, "and with drag" for a later one. `before`: the
// diagnosis of the model to which the effect was added; without it the label has the effect's name
// instead of its title.
std::string ModelLabel(size_t index, const std::string& added,
                       const std::optional<DiagnosisRecord>& before);

// What the test of adequacy has taken beside this effect: names of nuisances and of a second
// effect. Empty where it has examined a hypothesis without the effect.
std::vector<std::string> TestedBeside(const DiagnosisRecord& diagnosis, const std::string& effect);

// A statement that is at least this probable is more likely true than not.
inline constexpr double kLikely = 0.5;

// The nuisance of the model that explains most; of several that explain nearly as much, the first
// in the catalogue. Null: there is none.
const RecordedNuisance* BestAdoptedNuisance(const DiagnosisRecord& diagnosis);

// An error beyond the noise that the adopted nuisances explain: "corrected for the size of the
// elements, the error is 1.0 times the noise: choose a smaller mesh.max_volume". Names the nuisance
// that explains most. Empty where the error is noise as it is, or beyond noise even then.
std::string CorrectedError(const DiagnosisRecord& diagnosis);

// Why the verdict was reached, in whole sentences on one line.
std::string ExplainVerdict(const DiagnosisRecord& diagnosis);

// What would settle an open question, e.g. an experiment or a finer mesh, in phrases separated by
// semicolons. Empty where nothing is open.
std::string DescribeNextSteps(const DiagnosisRecord& diagnosis);

}  // namespace lacuna

#endif  // LACUNA_REPORT_VERDICT_TEXT_H_
