// The implicit time integrators.
//
// Each of them expresses velocity and acceleration at the end of a step as v = γ (x − x̃) and
// a = γ (v − ṽ), with a rate γ and combinations x̃, ṽ of earlier states. ṽ is made from velocities
// and accelerations as x̃ is made from positions and velocities. With the step length h:
//   implicit Euler   γ = 1/h        x̃ = xₙ
//   BDF2             γ = 3/(2h)     x̃ = (4 xₙ − xₙ₋₁)/3
//     after a step of a different length h/ω:
//                    γ = (1+2ω)/(1+ω)/h    x̃ = ((1+ω)² xₙ − ω² xₙ₋₁)/(1+2ω)
//   two-step         γ = 1/(β h)    x̃ = −α xₙ + (1+α) xₙ₋₁ + β h (2ρ vₙ + ρ² vₙ₋₁),
//                    β = 2/((1+ρ)(3−ρ)),  α = 4 β (1+ρ) − 4,  ρ = 0.6
//     after a step of a different length, the trapezoidal rule:
//                    γ = 2/h        x̃ = xₙ + ½ h vₙ
//   quasi-static     no inertia;    v = (x − xₙ)/h for rate-dependent effects, 0 without a step
// The two-step scheme is the A-stable scheme of second order with the double root −ρ as its
// amplification at infinite frequency (P. Masarati, M. Lanz, P. Mantegazza, 16th AIDAA Congress,
// 2001). It is BDF2 for ρ = 0; for ρ = 0.6 its error is 3.4 times smaller than that of BDF2 and
// close to that of the trapezoidal rule. Two-step schemes start with one step of implicit Euler,
// because no acceleration is known before and loads may begin with that step. The error of this
// single step is of second order too.
#ifndef LACUNA_FEM_TIME_SCHEME_H_
#define LACUNA_FEM_TIME_SCHEME_H_

namespace lacuna {

enum class TimeScheme { kQuasiStatic, kImplicitEuler, kBdf2, kTwoStep };

// The order of accuracy: the global error is proportional to this power of the step length. A
// quasi-static motion has an error of first order if effects depend on rates or have memory, and
// none otherwise.
int OrderOf(TimeScheme scheme);

// The weights of earlier states.
struct SchemeWeights {
  double rate = 0;  // γ, 1/s
  // x̃ = now·xₙ + before·xₙ₋₁ + rate_now·vₙ + rate_before·vₙ₋₁, and ṽ likewise of v and a.
  double now = 1, before = 0;
  double rate_now = 0, rate_before = 0;  // s

  // x̃ from positions and velocities, or ṽ from velocities and accelerations. Arguments with zero
  // weight are not read and may be empty.
  template <typename Matrix, typename Combined = Matrix>
  Combined Combine(const Matrix& value, const Matrix& previous_value, const Matrix& its_rate,
                   const Matrix& previous_rate) const {
    Combined combined = now * value;
    if (before != 0) combined += before * previous_value;
    if (rate_now != 0) combined += rate_now * its_rate;
    if (rate_before != 0) combined += rate_before * previous_rate;
    return combined;
  }
};

// The weights of a step of length h (s, > 0) after `steps_before` steps; only 0, 1 and larger
// values are distinguished. `last` is the length of the previous step, s; 0: h.
SchemeWeights WeightsOf(TimeScheme scheme, double h, int steps_before, double last = 0);

}  // namespace lacuna

#endif  // LACUNA_FEM_TIME_SCHEME_H_
