// What a diagnosis has found: the verdict, and everything that it rests on.
#ifndef LACUNA_DIAGNOSIS_DIAGNOSIS_RESULT_H_
#define LACUNA_DIAGNOSIS_DIAGNOSIS_RESULT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "diagnosis/effect_ranking.h"
#include "diagnosis/effect_refit.h"

namespace lacuna {

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

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_DIAGNOSIS_RESULT_H_
