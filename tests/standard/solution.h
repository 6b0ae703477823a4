// Solves a standard problem on one mesh, with the library as a prediction uses it.
#ifndef LACUNA_STANDARD_SOLUTION_H_
#define LACUNA_STANDARD_SOLUTION_H_

#include <string>
#include <vector>

#include "standard/problem.h"

namespace lacuna {

struct ProblemSolution {
  std::string message;         // why there is no solution; empty otherwise
  std::vector<double> values;  // of Problem::wanted, SI
  int nodes = 0;
  double seconds = 0;
  bool IsUsable() const { return message.empty(); }
};

ProblemSolution Solve(const Problem& problem, const ProblemMesh& mesh, int order);

// A refinement study: solutions on the meshes [0, count) with elements of one order.
struct RefinementStudy {
  int order = 1;
  std::vector<ProblemSolution> solutions;

  // |value − published| / |published| of a wanted quantity on a mesh; NaN without a solution.
  double Error(const Problem& problem, size_t mesh, size_t wanted) const;
  // The order of convergence that the last two meshes show, log(e₁/e₂)/log(h₁/h₂), where h is the
  // inverse of the cells, or of the steps if these alone differ. NaN where that is undetermined.
  double ObservedOrder(const Problem& problem, size_t wanted) const;
};
RefinementStudy Refine(const Problem& problem, int order, int count);

}  // namespace lacuna

#endif  // LACUNA_STANDARD_SOLUTION_H_
