// What these recordings could have revealed: the decision is repeated on simulated residuals.
//
// For each hypothesis that is still of interest, residuals are drawn as if it were true at the size
// that was found, with the noise of the recordings, from the products of the recordings themselves
// (hypothesis_space.h). The same rules decide upon each of them to first order. The frequencies say
// what the recordings would have shown, and are the probabilities of a right and of a wrong name.
#ifndef LACUNA_DIAGNOSIS_RECORDING_POWER_H_
#define LACUNA_DIAGNOSIS_RECORDING_POWER_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/decision_input.h"
#include "record/decision_record.h"

namespace lacuna {

// An effect at a size: the columns of one of its variants in a space, and its amounts.
struct FoundEffect {
  std::string name;
  std::vector<int> columns;  // indices in HypothesisSpace::model; empty: it was not found
  Eigen::VectorXd amounts;   // per column, in its unit

  bool IsNothing() const { return columns.empty() || amounts.isZero(0); }
};

// The best variant of an effect in the residual of the space, to first order, with its amounts.
FoundEffect FindEffect(const HypothesisSpace& space, const std::string& effect);

// `effects`: the effects that are taken for the truth, one after another, after "nothing". The
// result depends on the arguments and on DecisionInput::seed alone.
std::vector<RecordedPower> SimulatePower(const DecisionInput& input,
                                         const std::vector<std::string>& effects);

// SimulatePower() for one effect. If `is_known` is false, it is taken out of the catalogue, and the
// right answer is that something unknown is left. Nothing where the residual does not show the
// effect.
std::optional<RecordedPower> PowerToFind(DecisionInput input, const std::string& effect,
                                         bool is_known);

// λ between each pair of these effects: how far the prediction of the first at the size that was
// found is from the nearest prediction of any variant of the second, the smaller of the two
// directions.
std::vector<RecordedSeparation> Separations(const DecisionInput& input,
                                            const std::vector<std::string>& effects);
// Separations() of effects at given sizes, which need not be those of the residual of `space`. They
// may be pairs of effects, named as hypotheses of `space`: a pair can make every prediction of one
// of its effects, so that λ between the two is the distance of the pair's prediction alone.
std::vector<RecordedSeparation> SeparationsOf(const HypothesisSpace& space,
                                              const std::vector<FoundEffect>& effects);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_RECORDING_POWER_H_
