// How the end of a step depends on the states before it.
//
// Every implicit integrator that Lacuna uses writes velocity and acceleration at the end of the
// step as v = γ (x − x̃) and a = γ (v − ṽ), with a rate γ and combinations x̃, ṽ of earlier states,
// ṽ of velocities and accelerations as x̃ of positions and velocities:
//   implicit Euler   γ = 1/h        x̃ = xₙ
//   BDF2             γ = 3/(2h)     x̃ = (4 xₙ − xₙ₋₁)/3
//     after a step of another length, h/ω:
//                    γ = (1+2ω)/(1+ω)/h    x̃ = ((1+ω)² xₙ − ω² xₙ₋₁)/(1+2ω)
//   two-step         γ = 1/(β h)    x̃ = −α xₙ + (1+α) xₙ₋₁ + β h (2ρ vₙ + ρ² vₙ₋₁),
//                    β = 2/((1+ρ)(3−ρ)),  α = 4 β (1+ρ) − 4,  ρ = 0.6
//     after a step of another length, the trapezoidal rule:
//                    γ = 2/h        x̃ = xₙ + ½ h vₙ
//   quasi-static     no inertia;    v = (x − xₙ)/h for rate-dependent effects, 0 without a step
// The two-step scheme is the A-stable one of second order whose amplification of what is too fast
// for the step is −ρ, twice (P. Masarati, M. Lanz, P. Mantegazza, 16th AIDAA Congress, 2001): BDF2
// for ρ = 0, and near the trapezoidal rule's accuracy for the ρ here, its error 3.4 times less than
// BDF2's. Schemes of two steps begin with one of implicit Euler, whose error is of second order as
// one step's is: no acceleration is known before it, loads may begin with it.
#ifndef LACUNA_FEM_TIME_SCHEME_H_
#define LACUNA_FEM_TIME_SCHEME_H_

namespace lacuna {

enum class TimeScheme { kQuasiStatic, kImplicitEuler, kBdf2, kTwoStep };

// The power of the step that its error goes with at least; a quasi-static motion has one only where
// effects depend on rates (to first order) or remember.
int OrderOf(TimeScheme scheme);

struct SchemeWeights {
  double rate = 0;  // γ, 1/s
  // x̃ = now·xₙ + before·xₙ₋₁ + rate_now·vₙ + rate_before·vₙ₋₁, and ṽ likewise of v and a.
  double now = 1, before = 0;
  double rate_now = 0, rate_before = 0;  // s

  // Of positions and velocities, or of velocities and accelerations; what has no weight is not
  // read.
  template <typename Matrix>
  Matrix Combine(const Matrix& value, const Matrix& previous_value, const Matrix& its_rate,
                 const Matrix& previous_rate) const {
    Matrix combined = now * value;
    if (before != 0) combined += before * previous_value;
    if (rate_now != 0) combined += rate_now * its_rate;
    if (rate_before != 0) combined += rate_before * previous_rate;
    return combined;
  }
};

// Of a step of length h > 0, s, after `steps_before` (only 0, 1 and more differ), the last of them
// of length `last`, s; 0: of length h.
SchemeWeights WeightsOf(TimeScheme scheme, double h, int steps_before, double last = 0);

}  // namespace lacuna

#endif  // LACUNA_FEM_TIME_SCHEME_H_
