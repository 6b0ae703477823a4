// Which physical effect a fitted model lacks.
//
// 1. Every effect of the catalogue, and every nuisance that may pass for one, is tried on the
//    fitted trajectory to first order, all in one tangent-linear run, and scored by the evidence
//    for it (study/effect_ranking.h); what has no derivative, in a pilot run of its own
//    (study/pilot_hypotheses.h).
// 2. The best effects are added to the model one at a time and fitted with it. What counts is the
//    evidence of all frames, those that were not fitted among them, with noise that is no smaller
//    and no less correlated than what the best of them leaves.
// 3. A control runs the scoring on that remainder, shuffled so that no effect is in it: an effect
//    must do better than what the control finds.
// 4. The verdict says what this allows to say, no more.
// docs/diagnosis.md explains the method and its limits.
#ifndef LACUNA_STUDY_DIAGNOSIS_H_
#define LACUNA_STUDY_DIAGNOSIS_H_

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "core/progress.h"
#include "study/calibration_problem.h"
#include "study/effect_ranking.h"
#include "study/effect_refit.h"

namespace lacuna {

struct DiagnosisOptions {
  int refits = 3;  // of the best scored effects; more: slower, a wrong ranking is forgiven
  std::vector<std::string> without;  // effects that are not to be considered
};

// A scored effect, and what came of fitting it.
struct RankedEffect {
  ScoredEffect scored;
  // After the refit, where there was one.
  bool refitted = false;
  std::string refit_message;  // why it is not usable; empty: it is
  ModelErrors errors;
  double evidence = 0;           // ln of the odds against the model as it is
  double held_out_evidence = 0;  // the part of it that held-out frames alone give
  double explained = 0;          // share of the squared misfit that went
  double left_in_noise = 0;      // over all frames, adopted nuisances at their best, in σ
  FurtherEvidence further;       // for another effect beside it
  Eigen::VectorXd values;        // the effect's parameters there; empty: there is no usable refit
  std::vector<ParameterEstimate> sizes;  // of those that make its size (scored.score.size)
  std::vector<NamedEstimate> others;     // as in EffectRefit
};

struct Diagnosis {
  enum class Verdict { kAdequate, kMissing, kAmbiguous, kNuisance, kNotInLibrary, kNoPower };
  Verdict verdict = Verdict::kNoPower;
  std::vector<std::string> effects;  // named by the verdict, nuisances too
  std::string explanation;           // in words
  std::string experiment;            // that would settle it; empty: none is needed
  double noise = 0, scan_noise = 0;  // m: of a marker's coordinate, of a scanned point
  double time_step = 0;              // s, that it was made with
  NoiseLevel noise_level;
  ModelErrors errors;                     // of the present model
  std::vector<RankedEffect> ranking;      // by first order's evidence
  std::vector<UntriedEffect> untried;     // as in EffectRanking
  std::vector<ScoredNuisance> nuisances;  // as in EffectRanking
  // What effects would do in place of the nuisances that were adopted beyond those that every model
  // has; where no effect has evidence beside them.
  struct Instead {
    std::vector<RankedEffect> effects;  // refitted without those nuisances; evidence: against bare
    double nuisances_evidence = 0;      // evidence of the nuisances against bare
    ModelErrors bare;                   // of the model with neither
  } instead;
  int scored = 0;      // effects and variants
  double control = 0;  // the evidence that one in twenty controls finds without an effect
  // Over all frames, adopted nuisances at their best, in σ: of the present model, and of the best
  // hypothesis.
  double present_in_noise = 0, left_in_noise = 0;
};

std::string VerdictName(Diagnosis::Verdict verdict);

// Of the study fitted to `fitted` (CalibrationProblem::parameters). Where the study leaves its step
// open, and what is not known of the step's error could lend an effect its evidence, the study is
// fitted and diagnosed with shorter steps. `kept`: where fits are kept, so that one that is stopped
// goes on there. Throws Interrupted.
Diagnosis Diagnose(const CalibrationProblem& problem, const Eigen::VectorXd& fitted,
                   const DiagnosisOptions& options, Progress* progress, RefitStore* kept = nullptr);

}  // namespace lacuna

#endif  // LACUNA_STUDY_DIAGNOSIS_H_
