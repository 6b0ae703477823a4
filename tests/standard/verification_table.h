// The table of the standard problems in docs/verification.md.
#ifndef LACUNA_STANDARD_VERIFICATION_TABLE_H_
#define LACUNA_STANDARD_VERIFICATION_TABLE_H_

#include <string>
#include <vector>

#include "standard/solution.h"

namespace lacuna {

struct SolvedProblem {
  Problem problem;
  std::vector<RefinementStudy> studies;  // one for each order of elements
};

// Markdown: for each problem its title, source and remark, and a table with one row for each
// wanted quantity and order of elements: the published value, the value on the finest mesh, the
// relative error on each mesh, the observed order of convergence; then the results of peers.
std::string VerificationTable(const std::vector<SolvedProblem>& problems);

}  // namespace lacuna

#endif  // LACUNA_STANDARD_VERIFICATION_TABLE_H_
