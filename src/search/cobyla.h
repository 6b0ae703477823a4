// COBYLA: constrained optimisation by linear approximation, without derivatives.
//
// M. J. D. Powell, "A direct search optimization method that models the objective and constraint
// functions by linear interpolation", in Advances in Optimization and Numerical Analysis, 1994. The
// linear interpolation of f and c at the n + 1 vertices of a simplex is minimised within a ball
// (trust_region_step.h); points are judged by f + μ max(0, max_i -c_i) with a penalty μ that grows
// as steps need it.
//
// Bounds are kept at each evaluation: they are exact linear constraints of the trust-region
// problem, and vertices and geometry steps turn to the other side or shorten at them. A trial point
// that fails is a poor step, and never enters the simplex; a vertex of the first simplex that fails
// wherever it is tried counts as worse than the worst by more than the spread of all.
//
// The path depends on the outcomes of the evaluations alone: one thread, sums in one written order
// (ordered_algebra.h) and lengths that are equal by construction compared beyond their rounding, so
// that it is the same to the last bit without optimisation and with any vector instructions. Each
// loop has a cap.
#ifndef LACUNA_SEARCH_COBYLA_H_
#define LACUNA_SEARCH_COBYLA_H_

#include "search/search_problem.h"

namespace lacuna {

enum class CobylaMode {
  // The rules of 1994: one radius, halved whenever the geometry is acceptable and a step is poor.
  // Other than there: the bounds; the trust-region problem is solved exactly; ties go to the vertex
  // of less merit; and where the best vertex is infeasible in the end, one step more is tried.
  kPowell,
  // A trust radius that grows and shrinks with the success of the steps, above a resolution that
  // falls when neither steps nor geometry promise more, as in Powell's later methods; steps count
  // as short below a tenth of the resolution; the farthest vertex is the one to move; the vertex to
  // drop is chosen by its distance times its Lagrange function. These departures follow Z. Zhang,
  // "PRIMA: Reference Implementation for Powell's Methods with Modernization and Amelioration",
  // 2023 (www.libprima.net).
  kModern,
};

// A descent on a noisy or stepped objective contracts onto an accidental low. It is ended early and
// begun again at the best point with a wide simplex, until the budget is used or nothing is gained.
struct CobylaRestarts {
  int max_restarts = 0;      // 0: one descent to final_radius
  double resolution = 0.1;   // each descent ends at this multiple of its initial radius
  double shrink = 0.8;       // the initial radius of a descent over that of the one before
  double min_radius = 0.02;  // no descent begins below: the size of a step of the objective
};

struct CobylaOptions {
  CobylaMode mode = CobylaMode::kModern;
  // Radii in the units of the variables, which should be scaled alike (search_space.h): the size of
  // the first steps, and the accuracy at which to end. The initial radius is cut to half of the
  // narrowest free range; a final one below 1e-14 of the initial one is raised to that.
  double initial_radius = 0.25;
  double final_radius = 1e-3;
  CobylaRestarts restarts;
};

SearchResult MinimiseByCobyla(const SearchProblem& problem, const SearchControl& control,
                              const CobylaOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SEARCH_COBYLA_H_
