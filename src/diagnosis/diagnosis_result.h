// The result of a diagnosis: the conclusion, and everything that it rests on.
//
// RecordOf (diagnosis/recorded_diagnosis.h) turns it into plain data.
#ifndef LACUNA_DIAGNOSIS_DIAGNOSIS_RESULT_H_
#define LACUNA_DIAGNOSIS_DIAGNOSIS_RESULT_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/decision_input.h"
#include "diagnosis/effect_ranking.h"
#include "diagnosis/effect_refit.h"
#include "record/agreement_record.h"
#include "record/by_data_kind.h"
#include "record/decision_record.h"
#include "record/verdict.h"

namespace lacuna {

// A scored effect, and the result of fitting the model with it, which SetRefit (variant_refit.h)
// describes here.
struct RankedEffect {
  ScoredEffect scored;
  bool refitted = false;        // the fields below are those of the refit
  std::string refit_message;    // why it is not usable; empty: it is usable
  std::string unconverged;      // as in EffectRefit
  bool predicts = true;         // as Predicts (effect_refit.h) says
  bool fails_at_limit = false;  // as in RecordedRefit
  ModelErrors errors;
  double evidence = 0;                // as in RecordedRefit (record/diagnosis_record.h)
  double penalty_of_effects = 0;      // for the choice among all effects, subtracted in `evidence`
  double held_out_evidence = 0;       // the part of it that the held-out frames contribute
  double explained = 0;               // share of the squared misfit
  std::optional<ByDataKind> removed;  // RemovedMisfit (removed_misfit.h) of the refit
  double rms_over_sigma = 0;          // all frames, with the adopted nuisances at their best
  Eigen::VectorXd values;             // the effect's parameters; empty: there is no usable refit
  Eigen::VectorXd baseline_values;    // as in EffectRefit
  std::vector<ParameterEstimate> sizes;  // of the parameters that make its size
  std::vector<bool> at_limit;            // as in EffectRefit
  std::vector<NamedEstimate> others;     // as in EffectRefit

  bool HasUsableRefit() const { return refitted && refit_message.empty(); }
};

// Effects fitted in place of the nuisances that were adopted beyond those that every model has.
// Computed for a verdict "nuisance" only.
struct NuisanceAlternatives {
  std::vector<RankedEffect> effects;    // evidence against the bare model
  std::vector<HypothesisSpace> spaces;  // along their refits, with the nuisances as hypotheses
  double nuisances_evidence = 0;        // of the nuisances against the bare model
  ModelErrors bare;                     // of the model without both
};

struct Diagnosis : Conclusion {
  double noise = 0, scan_noise = 0;  // m, σ of a marker's coordinate and of a scanned point
  double time_step = 0;              // s, of the simulations
  NoiseLevel noise_level;
  ModelErrors errors;                     // of the baseline model
  std::vector<RankedEffect> ranking;      // by first-order evidence
  std::vector<UntriedEffect> untried;     // as in EffectRanking
  std::vector<ScoredNuisance> nuisances;  // as in EffectRanking
  NuisanceAlternatives alternatives;
  int scored = 0;  // number of effects and variants
  DecisionInput decision_input;
  DecisionRecord decision;
  AgreementRecord agreement;  // of the recordings about the parameters of the fitted model
  // Over all frames, with the adopted nuisances at their best: of the baseline model, and of the
  // best-fitting one, i.e. the one with the smallest residual of it and of all refits with
  // one effect or two that are not refuted.
  double baseline_rms_over_sigma = 0, best_rms_over_sigma = 0;
};

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_DIAGNOSIS_RESULT_H_
