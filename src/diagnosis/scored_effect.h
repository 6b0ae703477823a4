// Effects and nuisances with the evidence that first order gives them.
#ifndef LACUNA_DIAGNOSIS_SCORED_EFFECT_H_
#define LACUNA_DIAGNOSIS_SCORED_EFFECT_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "analysis/linear_evidence.h"
#include "diagnosis/candidates.h"
#include "diagnosis/hypothesis_score.h"
#include "diagnosis/nuisance_candidates.h"

namespace lacuna {

// An effect in one of its variants.
struct ScoredVariant {
  CandidateEffect candidate;
  Score score;
  Eigen::VectorXd fitted;  // what the problem's parameters would become with it
};

// An effect in the best of its variants.
struct ScoredEffect : ScoredVariant {
  std::vector<std::string> parameters, units;  // of score.size
  std::vector<std::string> look_alikes;        // effects that first order cannot tell from this one
  // Other variants that are better than their neighbours along their line, the best first: softer
  // here may look like stiffer there.
  std::vector<ScoredVariant> elsewhere;
};

struct ScoredNuisance {
  NuisanceCandidate candidate;
  double evidence = 0;                  // to first order
  std::optional<double> refitted = {};  // once the model with it has been fitted again
  double explained = 0;
  bool adopted = false;  // it is so certain that the model is taken with it from here on
  // Evidence that what is unknown of its change (NuisanceCandidate::unknown) could lend to an
  // effect.
  double doubt = 0;
};

// Columns of nuisances that are part of the model, in rows of a LinearisedMisfit.
struct AdoptedNuisances {
  Eigen::MatrixXd by;
  std::vector<LinearPrior> priors;
  Eigen::Index always = 0;  // the first columns, which every model has

  AdoptedNuisances Always() const;
  AdoptedNuisances And(const NuisanceCandidate& nuisance) const;
  bool HasMore() const { return by.cols() > always; }
};

// What a variant of an effect, or a nuisance, would change, in rows of a LinearisedMisfit.
struct TriedVariant {
  std::string type;
  Eigen::MatrixXd by;
  std::vector<LinearPrior> priors;
  double price = 0;  // of having tried its rivals too
  bool is_nuisance = false;
};

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_SCORED_EFFECT_H_
