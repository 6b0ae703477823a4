// The order in which the free nodes of a body are eliminated from its matrix.
#ifndef LACUNA_FEM_ELIMINATION_ORDER_H_
#define LACUNA_FEM_ELIMINATION_ORDER_H_

#include <vector>

#include "fem/block_matrix.h"

namespace lacuna {

struct EliminationOrder {
  std::vector<int> node;   // node[k]: the k-th free node to be eliminated
  std::vector<int> place;  // place[node[k]] = k; −1 for a fixed node

  int FreeNodes() const { return static_cast<int>(node.size()); }
};

// Nested dissection by METIS of the graph of free nodes (nine times fewer edges than that of the
// degrees of freedom, and it keeps the three of a node together). The same input gives the same
// order on every run. `fixed`: one flag per node.
EliminationOrder NestedDissection(const BlockPattern& pattern, const std::vector<char>& fixed);

}  // namespace lacuna

#endif  // LACUNA_FEM_ELIMINATION_ORDER_H_
