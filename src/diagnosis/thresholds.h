// All numeric thresholds of the diagnosis, in one place.
//
// Evidence is the natural logarithm of the odds against the model without the hypothesis; 3 stands
// for odds of 20 to 1, 5 for 150 to 1. A rms "over σ" is a rms residual divided by the standard
// deviation of the noise, so that 1 is noise alone. Each threshold says what a higher and a lower
// value trade. Tolerances of a solver stay beside the solver.
#ifndef LACUNA_DIAGNOSIS_THRESHOLDS_H_
#define LACUNA_DIAGNOSIS_THRESHOLDS_H_

namespace lacuna {

// When an error counts as noise, and when a nuisance explains it (verdict.h).
struct AdequacyThresholds {
  // An rms over σ of all frames up to this is noise.
  // Higher: small effects pass for noise. Lower: imperfections of the model ask for an effect.
  double noise = 1.2;
  // The same for held-out frames alone, which also contain the error of the parameters that the
  // fitted frames leave uncertain.
  // Higher: a model that predicts poorly counts as adequate. Lower: uncertain parameters do not.
  double held_out_noise = 1.3;
  // Where more than noise remains, a nuisance must explain this share of the squared misfit to be
  // named as the cause. Higher: more verdicts "not in library". Lower: more verdicts "nuisance"
  // where physics is missing.
  double nuisance_share = 0.5;
  // Where the error is noise, a nuisance that explains less than this share is mentioned only.
  // Higher: real but harmless nuisances are named less often. Lower: more often.
  double negligible_share = 0.05;
  // Mesh and time step are named where they would change this share of the squared misfit.
  // Higher: a coarse discretisation goes unnoticed. Lower: it is named where it hardly matters.
  double discretisation_share = 0.25;
};

// When an effect is named, and which rivals are named beside it (verdict.h).
struct NamingThresholds {
  // The least evidence of a named effect.
  // Higher: fewer false names, more misses. Lower: the reverse.
  double least_evidence = 5;
  // The best effect is named alone if it leads its rivals by this share of its own evidence, within
  // the two limits: the model to which both are added is imperfect, and its error favours one of
  // two equally good effects by chance, in proportion to the evidence.
  // Higher: more ambiguous verdicts. Lower: more wrong names.
  double lead_share = 0.25;
  double least_lead = 3, most_lead = 10;
  // The evidence that an uncertain discretisation could account for, in multiples of what lies
  // along the uncertain direction; 2, because it may favour one rival and disfavour another.
  // Higher: effects are named on fine meshes only. Lower: the mesh passes for an effect.
  double discretisation_factor = 2;
  // An effect with more evidence is present even if the interval of its size contains 0. Intervals
  // are linear, and mean little where the effect's other parameters lose their meaning at size 0
  // (Davies, Biometrika 64, 1977).
  // Higher: certain effects of uncertain size are missed. Lower: effects of size 0 are named.
  double evidence_beyond_intervals = 10;
  // Evidence that the held-out frames may contribute against an effect by chance.
  // Higher: effects that predict poorly are named. Lower: chance rules out the right effect.
  double held_out_loss = 3;
  // An effect that predicts the recordings that were not fitted better, by this rms over σ, stays a
  // rival, since evidence does not count these recordings. The noise of some thousand measurements
  // changes their rms by as much.
  // Higher: fewer ambiguous verdicts, more wrong names. Lower: noise makes rivals.
  double better_prediction = 0.03;
  // The nuisances in the model are linear, and an effect may explain what their linearisation
  // omits. Its evidence must exceed this share of theirs.
  // Higher: effects beside strong nuisances are missed. Lower: nuisances pass for effects.
  double linearisation_share = 0.1;
  // A grip that yields changes the frequencies of the object, which a linearisation follows for a
  // short time only. It is a rival with this share of the best effect's evidence.
  // Higher: a yielding grip passes for an effect. Lower: more ambiguous verdicts.
  double grip_share = 0.5;
  // Where more than noise remains, the best effect must explain this share of the squared misfit in
  // excess of the noise. Higher: more verdicts "not in library" where the effect is right and the
  // model otherwise imperfect. Lower: an effect that compensates for another one is named.
  double explained_share = 0.85;
  // The same holds if it leaves more than this share of its own evidence to another effect.
  // Higher: an effect that compensates for another one is named. Lower: chance refuses the name.
  double remainder_share = 0.05;
  // An effect is a rival of the adopted nuisances with this share of their evidence, if it also
  // lowers the rms over σ of the held-out frames to the second share: a time error of each frame
  // follows every frame as well as physics does, and predicts none.
  // A higher first or a lower second share: more verdicts "nuisance" where physics is missing.
  double alternative_share = 0.75, alternative_error = 0.9;
};

struct DiagnosisThresholds {
  AdequacyThresholds adequacy;
  NamingThresholds naming;
};

inline constexpr DiagnosisThresholds kThresholds{};

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_THRESHOLDS_H_
