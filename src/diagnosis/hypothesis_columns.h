// The columns of everything that a first-order ranking weighs, along one motion.
//
// One tangent-linear simulation gives the changes of the residual by the model's parameters, the
// sizes of all effects in all their variants, and the motions of the grips. Effects without a
// derivative are simulated by themselves (pilot_hypotheses.h), and so are the nuisances of the
// mesh, the time step and the shape (nuisance_catalogue.h). All of them become columns of one
// linear Gaussian model (hypothesis_score.h).
#ifndef LACUNA_DIAGNOSIS_HYPOTHESIS_COLUMNS_H_
#define LACUNA_DIAGNOSIS_HYPOTHESIS_COLUMNS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "analysis/linear_evidence.h"
#include "calibration/calibration_problem.h"
#include "calibration/linear_misfit.h"
#include "core/progress.h"
#include "diagnosis/candidate_effect.h"
#include "diagnosis/effect_ranking.h"
#include "diagnosis/nuisance.h"
#include "diagnosis/scene_columns.h"
#include "record/model_errors.h"

namespace lacuna {

// What an earlier ranking of the same recordings has decided: which nuisances are part of the
// model, beside those of every model, and how large the noise is. The columns of these nuisances
// are those along the motion of the new ranking; one that cannot be made there, such as a bad frame
// that is not the worst one along that motion, keeps the columns of the earlier ranking.
struct DecidedBase {
  const EffectRanking& ranking;
  NoiseLevel noise;
};

struct HypothesisColumns {
  Eigen::VectorXd values;   // of the problem's parameters: the fitted ones
  LinearisedMisfit misfit;  // there, with the Jacobian of the parameters first
  // Changes of the rows of the misfit, m per unit amount, and the priors of the amounts.
  Eigen::MatrixXd columns;
  std::vector<LinearPrior> priors;

  // Indices of columns: of the problem's parameters, of the nuisances of every model, and of all
  // that the model contains before the ranking adopts more: these two and the decided nuisances.
  std::vector<int> parameters, always, base;
  // All variants of all effects, the pilots last, and the nuisances that have columns in the order
  // of the catalogue, without the decided ones; each with the indices of its columns.
  std::vector<CandidateEffect> candidates;
  std::vector<std::vector<int>> of_candidate;
  std::vector<NuisanceCandidate> nuisances;
  std::vector<std::vector<int>> of_nuisance;
  std::vector<UntriedEffect> untried;  // and nuisances, by the names of their cards
  Eigen::MatrixXd unknown_force;       // as in EffectRanking; not among `columns`

  NoiseLevel noise;
  double explained_misfit = 0;  // as PredictionStudy has it
  SceneColumns scene;           // for further rankings

  Eigen::MatrixXd ColumnsOf(const std::vector<int>& indices) const {
    return columns(Eigen::all, indices);
  }
  std::vector<LinearPrior> PriorsOf(const std::vector<int>& indices) const;
};

// The columns beside the study of `problem` with the fitted `values`, of the catalogue's effects
// but for the types in `without`. What `known` has is taken from there instead of simulated. Null
// `decided`: there is no earlier ranking. Begins two stages: "effects", one simulation with the
// derivatives by all effects that have any, and "score", which counts the frames of the pilots and
// which the caller ends. CHECKs that the model can be predicted there. Throws Interrupted.
HypothesisColumns MakeHypothesisColumns(const CalibrationProblem& problem,
                                        const Eigen::VectorXd& values, Progress* progress,
                                        const std::vector<std::string>& without,
                                        const SceneColumns& known, const DecidedBase* decided);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_HYPOTHESIS_COLUMNS_H_
