// Everything that a decision weighs along one motion: the products of the whitened residual and of
// the columns of all hypotheses.
//
// With the residual r and the columns A of all hypotheses, whitened with the noise, the decision
// needs rᵀr, Aᵀr and AᵀA only (analysis/linear_evidence.h). The base columns, which every
// hypothesis has, are the fitted parameters and the nuisances that belong to the model. Priors have
// mean 0: the residual is that of the base at the means of its priors. All of it is plain data, so
// that a decision can be repeated without the model (decision_store.h).
#ifndef LACUNA_DIAGNOSIS_HYPOTHESIS_SPACE_H_
#define LACUNA_DIAGNOSIS_HYPOTHESIS_SPACE_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "analysis/linear_evidence.h"

namespace lacuna {

enum class HypothesisKind { kEffect, kNuisance, kUnknownForce };

// One variant of an effect, one nuisance, or an unknown smooth force.
struct WeighedHypothesis {
  HypothesisKind kind = HypothesisKind::kEffect;
  std::string name;          // the effect's type or the nuisance's name; empty for an unknown force
  std::string variant;       // the place, direction or time of an effect's variant
  std::vector<int> columns;  // indices in HypothesisSpace::model
  double selection_penalty = 0;  // as in TriedVariant (scored_effect.h)
};

struct HypothesisSpace {
  LinearGaussianModel model = LinearGaussianModel::FromProducts(0, {}, {}, {});
  double variance = 1;    // of the noise in the whitened rows
  Eigen::Index rows = 0;  // number of rows that were observed
  // ½ u², where u is the length, in units of the noise, of the error that the model may leave in an
  // unknown direction: the evidence that it could give to an effect along it. It is that of the
  // mesh and the time step, and kToleratedModelError of the misfit that the effects explain which
  // earlier diagnoses have added (decision_rules.h).
  double model_error = 0;
  std::vector<int> base;  // columns of the base
  std::vector<WeighedHypothesis> hypotheses;
};

// The space of a whitened residual and whitened columns. `means`: of the priors of the base
// columns, which come first; the priors of the result have mean 0. Columns without a finite prior
// keep their residual. CHECKs the sizes.
HypothesisSpace MakeHypothesisSpace(const Eigen::VectorXd& residual, const Eigen::MatrixXd& columns,
                                    std::vector<LinearPrior> priors, Eigen::Index base,
                                    std::vector<WeighedHypothesis> hypotheses, double variance,
                                    Eigen::Index rows);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_HYPOTHESIS_SPACE_H_
