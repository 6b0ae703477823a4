// Estimates the smooth body force that would have made a fitted model follow the markers or the
// scans of a recording: evidence on which physics the model lacks.
//
// The amplitudes a of a smooth force (smooth_force.h) and the recording's nuisance parameters n
// (holding force, clock, registration) minimise
//   ½ |r(a, n)|²/v + ½ aᵀ (s² L Lᵀ)⁻¹ a + ½ nᵀ P⁻¹ n,
// where r is the residual, whitened as in the fit, and the fitted parameters of the model stay
// fixed. They are found by Gauss–Newton steps: the Jacobian is computed along the motion without
// the force, then along the motion with it (force_linearisation.h); along each motion, scanned
// points find their correspondences anew. The width s and the shape L of the prior (how uniform the
// force is over the object and how slowly it changes) and the variance v are chosen by their
// marginal likelihood (analysis/amplitude_estimate.h).
#ifndef LACUNA_COMPARISON_FORCE_ESTIMATE_H_
#define LACUNA_COMPARISON_FORCE_ESTIMATE_H_

#include "analysis/measurement_errors.h"
#include "comparison/unexplained_force.h"
#include "prediction/replayed_motion.h"

namespace lacuna {

// The force has one knot for every frame of the motion, at most this many. Larger: it can change
// faster in long recordings, and the estimate takes more time and memory.
inline constexpr int kMostForceKnots = 60;

// `motion` is that of the recording, replayed to its last frame with the fitted model and without
// the force. `errors` are those that the fit assumed. Takes up to eight further predictions. If the
// motion is too short, or no such force reduces the error enough, the record is not usable and its
// message says why.
UnexplainedForce EstimateUnexplainedForce(const RecordingModel& recording,
                                          const ReplayedMotion& motion,
                                          const MeasurementErrors& errors);

// Whether a full step ends the search: the error along the new motion is about the one that the
// linear model has predicted, and no more than 1 % larger than before the step (or than predicted,
// if that is larger). All three are rms of the whitened residual, in σ.
bool HasConverged(double rms_before, double expected_rms, double reached_rms);

}  // namespace lacuna

#endif  // LACUNA_COMPARISON_FORCE_ESTIMATE_H_
