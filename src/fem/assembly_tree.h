// Which columns of a sparse Cholesky factor are eliminated together, and what they pass on.
//
// The multifrontal method (Duff & Reid 1983; Liu, SIAM Review 34, 1992) gathers columns of like
// structure into supernodes. Supernode s owns `Columns(s)` consecutive nodes; its front is a dense
// matrix over these and the later nodes that they touch, the update rows. What it eliminates is
// passed on to the front of its parent. The tree of supernodes, and all places in memory, depend on
// the mesh alone.
#ifndef LACUNA_FEM_ASSEMBLY_TREE_H_
#define LACUNA_FEM_ASSEMBLY_TREE_H_

#include <cstdint>
#include <vector>

#include "fem/block_matrix.h"
#include "fem/elimination_order.h"

namespace lacuna {

// Consecutive update rows of a child that are consecutive in the front of its parent, in nodes.
struct RowRun {
  int from = 0;  // place among the child's update rows
  int to = 0;    // place in the parent's front
  int length = 0;
};

struct AssemblyTree {
  EliminationOrder order;  // the given one, postordered: all of a subtree's nodes are consecutive

  // Supernodes are numbered so that children come before parents.
  std::vector<int> column_begin;  // supernodes + 1: first column (a place in `order`)
  std::vector<int> row_begin;     // supernodes + 1: into `row`
  std::vector<int> row;           // update rows (places in `order`), ascending
  std::vector<int> parent;        // −1: a root
  std::vector<std::vector<int>> children;
  std::vector<std::vector<RowRun>> runs;  // from each supernode into its parent's front

  int SupernodeCount() const { return static_cast<int>(parent.size()); }
  int Columns(int s) const { return column_begin[s + 1] - column_begin[s]; }
  int UpdateRows(int s) const { return row_begin[s + 1] - row_begin[s]; }
  int FrontRows(int s) const { return Columns(s) + UpdateRows(s); }
};

AssemblyTree MakeAssemblyTree(const BlockPattern& pattern, const EliminationOrder& order);

// A cut through the tree for two and more threads: subtrees that can be eliminated at the same
// time, each by one thread, and the supernodes above them, one after another. It depends on the
// tree alone, so that the number of threads has no influence on any sum.
struct TreeCut {
  struct Subtree {
    int begin = 0, end = 0;  // consecutive supernodes; the last one is the subtree's root
  };
  std::vector<Subtree> subtrees;  // the dearest first
  std::vector<int> top;           // children before parents
};

// `cost[s]`: work at supernode s.
TreeCut CutTree(const AssemblyTree& tree, const std::vector<double>& cost);

}  // namespace lacuna

#endif  // LACUNA_FEM_ASSEMBLY_TREE_H_
