// The order in which the free nodes of a body are eliminated in a Cholesky factorisation.
//
// It determines the fill-in of the factor, and with it time and memory.
#ifndef LACUNA_FEM_ELIMINATION_ORDER_H_
#define LACUNA_FEM_ELIMINATION_ORDER_H_

#include <vector>

#include "fem/block_matrix.h"

namespace lacuna {

struct EliminationOrder {
  std::vector<int> node;   // node[k] is eliminated as the k-th free node
  std::vector<int> place;  // n: place[node[k]] = k, and −1 for a fixed node

  int FreeNodes() const { return static_cast<int>(node.size()); }
};

// Orders the free nodes by nested dissection with METIS. The graph of nodes has nine times fewer
// edges than that of the degrees of freedom, and the three degrees of freedom of a node stay
// together. `fixed` holds one flag per node. The order is the same on every run. Thread-safe: calls
// of METIS are serialised.
EliminationOrder NestedDissection(const BlockPattern& pattern, const std::vector<char>& fixed);

}  // namespace lacuna

#endif  // LACUNA_FEM_ELIMINATION_ORDER_H_
