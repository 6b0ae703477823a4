// COBYLA: derivative-free constrained optimisation by linear approximation.
//
// M. J. D. Powell, "A direct search optimization method that models the objective and constraint
// functions by linear interpolation", in Advances in Optimization and Numerical Analysis, 1994. The
// linear interpolant of f and c at the n + 1 vertices of a simplex is minimised within a ball
// (trust_region_step.h). Points are compared by the merit f + μ max(0, max_i -c_i), whose penalty μ
// grows as needed.
//
// The bounds hold at each evaluation: they are exact linear constraints of the trust-region
// problem, and vertices and geometry steps are reflected or shortened at them. A trial point whose
// evaluation fails counts as a poor step and never enters the simplex. If no evaluation for a
// vertex of the initial simplex succeeds, the vertex is assigned a value that exceeds the largest
// value of the simplex by at least the range of its values.
//
// The path depends only on the outcomes of the evaluations: the search uses one thread, forms sums
// in a fixed order (ordered_algebra.h), and compares lengths that are equal by construction with a
// tolerance above the rounding error. The result is therefore the same to the last bit at every
// optimisation level of the compiler and with all vector instructions. The number of iterations of
// every loop is limited.
#ifndef LACUNA_SEARCH_COBYLA_H_
#define LACUNA_SEARCH_COBYLA_H_

#include "search/search_problem.h"

namespace lacuna {

enum class CobylaMode {
  // The rules of 1994: a single radius, which is halved whenever the geometry is acceptable and a
  // step is poor. The implementation differs from the paper in four points: it supports bounds; it
  // solves the trust-region problem exactly; of two equally suitable vertices it chooses the one
  // with the lower merit; and if the best vertex is infeasible at the end, it evaluates one more
  // step.
  kPowell,
  // A trust radius that grows and shrinks with the success of the steps, above a resolution that is
  // reduced when neither steps nor geometry improvements promise progress, as in Powell's later
  // methods. Steps count as short below a tenth of the resolution; geometry steps move the farthest
  // vertex; the vertex to replace is chosen by its distance times its Lagrange function. These
  // changes follow Z. Zhang, "PRIMA: Reference Implementation for Powell's Methods with
  // Modernization and Amelioration", 2023 (www.libprima.net).
  kModern,
};

// Restarts for a noisy or piecewise constant objective, on which a single descent would converge to
// a spurious local minimum. Each descent ends early, and the next one starts at the best point with
// a large simplex, until the evaluation limit is reached or two consecutive descents make no new
// evaluation.
struct CobylaRestarts {
  int max_restarts = 0;      // 0 for a single descent to final_radius
  double resolution = 0.1;   // each descent ends at this multiple of its initial radius
  double shrink = 0.8;       // ratio of the initial radii of successive descents
  double min_radius = 0.02;  // smallest initial radius: the distance between jumps of the objective
};

struct CobylaOptions {
  CobylaMode mode = CobylaMode::kModern;
  // The size of the first steps and the accuracy at which to stop, in the units of the variables,
  // which should have similar scales (search_space.h). The initial radius is limited to half of the
  // narrowest range of a free variable, and the final radius is at least 1e-14 of the initial one.
  // Both must be positive (CHECK).
  double initial_radius = 0.25;
  double final_radius = 1e-3;
  CobylaRestarts restarts;
};

// Minimises the objective. SearchResult::status gives the reason why the search ended. Throws
// InputError if the log cannot be used (evaluation_log.h), and any exception of the objective.
SearchResult MinimiseByCobyla(const SearchProblem& problem, const SearchControl& control,
                              const CobylaOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SEARCH_COBYLA_H_
