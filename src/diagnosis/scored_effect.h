// Effects and nuisances with the evidence that they have to first order, as plain values.
//
// Evidence is that of record/diagnosis_record.h. Columns have the rows of a LinearisedMisfit, in m
// per unit of the amount that they belong to.
#ifndef LACUNA_DIAGNOSIS_SCORED_EFFECT_H_
#define LACUNA_DIAGNOSIS_SCORED_EFFECT_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "analysis/linear_evidence.h"
#include "diagnosis/candidate_effect.h"
#include "diagnosis/hypothesis_score.h"
#include "diagnosis/nuisance.h"

namespace lacuna {

// One variant of an effect: at one place, in one direction or with one time scale.
struct ScoredVariant {
  CandidateEffect candidate;
  Score score;
  Eigen::VectorXd expected_values;  // of the problem's parameters, with the effect in the model
  // −ln of ReachableShare() (refit_reach.h): what the choice of this variant among those of its
  // effect costs the evidence of a refit. A refit pays for the parameters that it moves through
  // their priors.
  double selection_penalty = 0;
};

// An effect in the variant with the most evidence.
struct ScoredEffect : ScoredVariant {
  std::vector<std::string> parameters, units;  // of score.size
  std::vector<std::string> look_alikes;  // effects that first order cannot distinguish from it
  // Where its refit ended: the fitted parameters that the model had before. Empty: no usable refit.
  Eigen::VectorXd baseline_values;
  // Further variants with more evidence than their neighbours in place, direction or time, the best
  // first: a bar that is softer at one end may look like one that is stiffer at the other.
  std::vector<ScoredVariant> elsewhere;
};

struct ScoredNuisance {
  NuisanceCandidate candidate;
  double evidence = 0;                  // to first order
  std::optional<double> refitted = {};  // evidence after a refit of the model with the nuisance
  double explained = 0;                 // share of the squared residual that it explains
  bool adopted = false;                 // part of the model
  // Evidence that the unknown part of the nuisance (NuisanceCandidate::unknown) could contribute to
  // an effect that happens to lie along it.
  double uncertain_evidence = 0;
};

// The nuisances that are part of the model.
struct AdoptedNuisances {
  Eigen::MatrixXd columns;
  std::vector<LinearPrior> priors;
  Eigen::Index always = 0;  // the first columns belong to nuisances that every model has

  AdoptedNuisances Always() const;  // only those
  AdoptedNuisances And(const NuisanceCandidate& nuisance) const;
  bool HasMore() const { return columns.cols() > always; }
};

// A variant of an effect, or a nuisance, as the ranking tried it.
struct TriedVariant {
  std::string type;     // of the effect, or the name of the nuisance
  std::string variant;  // of the effect
  Eigen::MatrixXd columns;
  std::vector<LinearPrior> priors;
  // ln of the number of alternatives from which it was selected before it was tried, such as the
  // frames among which one is bad.
  double selection_penalty = 0;
  bool is_nuisance = false;
  bool is_adopted = false;  // a nuisance that the ranking has taken into the model
};

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_SCORED_EFFECT_H_
