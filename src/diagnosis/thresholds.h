// All numeric thresholds of the diagnosis, in one place.
//
// Evidence is that of record/diagnosis_record.h; 3 stands for a factor of 20, 5 for 150. A rms
// "over σ" is a rms residual divided by the standard deviation of the noise, so that 1 is noise
// alone. Each threshold says what a higher and a lower value trade. Tolerances of a solver stay
// beside the solver.
#ifndef LACUNA_DIAGNOSIS_THRESHOLDS_H_
#define LACUNA_DIAGNOSIS_THRESHOLDS_H_

#include <cstddef>

namespace lacuna {

// The first-order ranking of effects and nuisances (rank_effects.h, hypothesis_score.h).
struct RankingThresholds {
  // The size of an effect is detectable if it exceeds so many of its standard deviations. Among
  // some dozens of effects, 5 find the right one in four cases of five.
  // Higher: small effects count as undetectable. Lower: sizes count that chance also produces.
  double detectable_deviations = 5;
  // Canonical correlation of two effects' columns above which first order cannot tell them apart.
  // Higher: a similar effect may be overlooked. Lower: more refits, more ambiguous verdicts.
  double look_alike_correlation = 0.95;
  // A nuisance enters the model if its evidence exceeds that of the best effect by this much.
  // Higher: effects are scored in the presence of an obvious nuisance. Lower: a nuisance may hide
  // the effect that is missing.
  double nuisance_lead = 5;
  // The largest number of nuisances that enter the model in this way.
  // Higher: slower, and more freedom for nuisances to imitate an effect.
  int most_adopted_nuisances = 3;
};

// Which hypotheses are refitted, and how a refit is judged (refits.h, nuisance_refits.h,
// effect_refit.h).
struct RefitThresholds {
  // An effect with less evidence is neither refitted nor looked at again.
  // Higher: faster, an effect that first order underrates is missed. Lower: pointless refits.
  double least_evidence = 3;
  // First order errs by some tens of per cent of the evidence, so effects beyond the number that
  // the user asks for are refitted too: those within `close_behind` of the best one, and those with
  // this share of the evidence of the last one that was asked for.
  // A larger `close_behind`, a smaller share: slower, a wrong ranking is corrected more often.
  double close_behind = 5;
  double share_of_last = 0.8;
  // An effect is not refitted if its first-order evidence lies below that of the best refit by this
  // much and by this share: its posterior probability would be negligible. Members of the best
  // effect's family are refitted all the same (RefitAll). Lower: faster, an effect that first order
  // underrates is missed.
  double beaten_by = 15, beaten_share = 0.3;
  // The largest number of refitted effects, unless the user asks for more.
  int most_effects = 6;
  // A fit of a refit ends after so many predictions. Once an effect has taken `most_of_effect`, no
  // further start is tried, and a fit that has not converged does not go on; the best parameters so
  // far count. Higher: a hopeless effect takes longer, and a slow minimum is found more often.
  int most_predictions = 60, most_of_effect = 120;
  // A refit also starts from other variants (places, times) with this share of the evidence of the
  // best variant. Lower: slower, fewer local minima.
  double variant_share = 0.8;
  // A nuisance with this share of the best effect's evidence, both to first order, is refitted, so
  // that both are judged by a refit. At most so many are.
  // A lower share, more nuisances: slower, a nuisance is ruled out more reliably.
  double rival_nuisance_share = 0.5;
  size_t most_rival_nuisances = 3;
  // An effect is tried in place of the adopted nuisances if first order gives it this share of
  // their evidence. Lower: slower, fewer effects hidden by a nuisance.
  double alternative_share = 0.5;
  // A model that is far from the measurements is also ranked over this share of the fitted time,
  // before its motion loses the phase of the measured one.
  // Higher: the motion may have lost the phase already. Lower: less data.
  double early_share = 0.25;
  // A time step is halved, so many times at most, where the unknown part of its error could
  // contribute this evidence to an effect, and more than what is tolerated in any case
  // (step_refinement.h).
  // Higher: faster, and more doubt about small effects.
  int most_halvings = 3;
  double uncertain_step_evidence = 1;

  // The rms over σ below which a residual counts as noise, so that a refit has found the right
  // minimum, whether or not its search has converged. If the model was far off, a refit that leaves
  // more is repeated from another start, and where all refits leave more, the effects are also
  // ranked over the first frames (early_share).
  // Higher: a refit may stay in a local minimum. Lower: every refit is made twice.
  double rms_at_noise = 1.2;
  // A refit is likely to have ended in a local minimum if it gains less than this share of the
  // evidence that first order predicts ...
  // Higher: more repeated refits. Lower: local minima are accepted.
  double kept_share = 0.5;
  // ... unless it explains this share of the squared residual in excess of the noise ...
  double explained_excess = 0.85;
  // ... where that excess is more than this share of the noise, which is only estimated.
  double noise_uncertainty = 0.2;
  // A refit is also likely to have ended in a local minimum if the rms of the held-out frames grows
  // by more than this factor. Higher: a misplaced refit is accepted. Lower: noise alone repeats a
  // refit.
  double held_out_growth = 1.1;
  // A first-order step that would reduce a modulus below this share of itself is not followed.
  double least_modulus_share = 0.2;
  // A fitted parameter may leave its plausible range by this share of the range; one on a
  // logarithmic scale may fall to the second share of the lower end.
  // Larger: a wrong effect can imitate another one at an implausible size.
  double range_margin = 0.1, log_range_share = 0.5;
};

// Priors of the nuisances: standard deviations of their amounts. Higher values let a nuisance
// explain more, so that effects need more evidence; lower values let effects explain errors of the
// experiment.
struct NuisanceThresholds {
  // A misplaced grip, frame or registration, or the end of a grip, m; a misoriented one, rad.
  double shift = 1e-3, rotation = 0.02;
  // The share by which measured forces may be wrong, all alike.
  double load_scale = 0.2;
  // By how much a parameter may differ between recordings: a positive one as a share of itself,
  // another one of half its plausible range.
  double parameter_difference = 0.2;
  // The time of a single frame, as a share of the frame spacing.
  double frame_time = 0.1;
  // The part of the last refinement's change that the fitted parameters cannot compensate for is
  // known to this share, in any direction. Calibrated on bars of 160 to 190 quadratic elements,
  // where refining twelvefold left 2 to 5 σ of an error of 70 to 95 σ in other directions.
  double mesh_unknown = 0.4;
  // Nuisances of single frames are left out of recordings with more frames: each frame is too small
  // a part of the data, and the columns would need too much memory.
  size_t most_single_frames = 400;
};

// Contact planes and other pilot simulations (pilot_hypotheses.h, plane_proposals.h).
struct PilotThresholds {
  // The largest number of planes that are tried. Higher: slower, one simulation each.
  size_t most_planes = 3;
  // Standard deviation of a plane's offset, m: measured points stand off the edges of the body,
  // which penetrate the plane. Higher: contact needs more evidence.
  double plane_offset = 2e-3;
  // Coefficient of friction of the pilot with friction.
  double friction = 0.5;
  // A plane is so many times as stiff as one element: it is then hard compared with the body, and
  // does not limit the time step. Higher: more iterations per step.
  double stiffness_ratio = 10;
  // Directions whose cosine is larger are tried once.
  double same_direction_cosine = 0.98;
};

struct DiagnosisThresholds {
  RankingThresholds ranking;
  RefitThresholds refit;
  NuisanceThresholds nuisances;
  PilotThresholds pilots;
};

inline constexpr DiagnosisThresholds kThresholds{};

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_THRESHOLDS_H_
