// The supernodal elimination tree of a sparse Cholesky factorisation by the multifrontal method.
//
// The method (Duff & Reid 1983; Liu, SIAM Review 34, 1992) groups columns of similar structure into
// supernodes. Supernode s eliminates Columns(s) consecutive nodes. Its front is a dense matrix over
// these nodes and the later nodes coupled to them, the update rows; after the elimination, the
// Schur complement of the update rows is added to the front of the parent. The tree depends on the
// pattern of the matrix and the elimination order only. All counts and places are in nodes, i.e. in
// blocks of three rows.
#ifndef LACUNA_FEM_ASSEMBLY_TREE_H_
#define LACUNA_FEM_ASSEMBLY_TREE_H_

#include <cstdint>
#include <vector>

#include "fem/block_matrix.h"
#include "fem/elimination_order.h"

namespace lacuna {

// A run of update rows of a child that is also consecutive in the front of its parent.
struct RowRun {
  int from = 0;    // first place among the update rows of the child
  int to = 0;      // first place in the front of the parent
  int length = 0;  // number of rows
};

struct AssemblyTree {
  EliminationOrder order;  // postordered, so that the nodes of each subtree are consecutive

  // Supernodes are numbered with children before parents.
  std::vector<int> column_begin;  // supernodes + 1: first column, a place in `order`
  std::vector<int> row_begin;     // supernodes + 1: first entry in `row`
  std::vector<int> row;           // update rows, places in `order`, ascending
  std::vector<int> parent;        // −1 for a root
  std::vector<std::vector<int>> children;
  std::vector<std::vector<RowRun>> runs;  // runs of each supernode in the front of its parent

  int SupernodeCount() const { return static_cast<int>(parent.size()); }
  int Columns(int s) const { return column_begin[s + 1] - column_begin[s]; }
  int UpdateRows(int s) const { return row_begin[s + 1] - row_begin[s]; }
  int FrontRows(int s) const { return Columns(s) + UpdateRows(s); }
};

// Builds the tree for the free nodes of a pattern. `order` must contain each free node once.
AssemblyTree MakeAssemblyTree(const BlockPattern& pattern, const EliminationOrder& order);

// A cut through the tree for parallel elimination: independent subtrees, each eliminated as one
// task, and the supernodes above them, eliminated one after another. The cut does not depend on the
// number of threads, so neither does the order of any summation.
struct TreeCut {
  struct Subtree {
    int begin = 0, end = 0;  // consecutive supernodes, of which the last one is the root
  };
  std::vector<Subtree> subtrees;  // in descending order of cost
  std::vector<int> top;           // children before parents
};

// Cuts the tree; `cost[s]` is the work at supernode s in any unit.
TreeCut CutTree(const AssemblyTree& tree, const std::vector<double>& cost);

}  // namespace lacuna

#endif  // LACUNA_FEM_ASSEMBLY_TREE_H_
