// Makes the input of a decision from a ranking and its refits.
#ifndef LACUNA_DIAGNOSIS_DECISION_MAKER_H_
#define LACUNA_DIAGNOSIS_DECISION_MAKER_H_

#include <Eigen/Core>
#include <vector>

#include "diagnosis/decision_input.h"
#include "diagnosis/diagnosis_result.h"
#include "diagnosis/refitted_ranking.h"
#include "diagnosis/scored_effect.h"
#include "diagnosis/variant_refit.h"

namespace lacuna {

// The input of a decision, without effects in place of adopted nuisances (AddAlternatives()).
// `nuisances`: those of the ranking, with the evidence of their refits (WeighNuisances).
DecisionInput MakeDecisionInput(const RefitContext& context, const RefittedRanking& ranked,
                                const RefitNoise& noise,
                                const std::vector<ScoredNuisance>& nuisances);

// Adds the effects that were refitted in place of the adopted nuisances.
void AddAlternatives(const NuisanceAlternatives& alternatives, DecisionInput* input);

// The logarithm of the Bayes factor between a prior of which one half is concentrated on vectors of
// the length `natural`, in any direction, and a normal prior with the standard deviation `prior` of
// each component, given the posterior mean and standard deviations under the latter. 0 where the
// posterior is too wide, relative to its mean, to speak about the length.
double NaturalValueEvidence(const Eigen::Vector3d& mean, const Eigen::Vector3d& deviation,
                            double prior, double natural);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_DECISION_MAKER_H_
