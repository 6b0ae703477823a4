#include "fem/assembly_tree.h"

#include <glog/logging.h>

#include <algorithm>
#include <numeric>

#include "core/disjoint_sets.h"

namespace lacuna {
namespace {

// Subtrees with more than this fraction of the total cost are divided, to balance the threads.
constexpr double kLargestSubtree = 1.0 / 12;

// A child is merged into its parent if the fraction of explicit zeros that the merged supernode
// stores stays below a limit. The limit decreases with the number of columns, because dense kernels
// are inefficient for few columns.
struct MergeRule {
  int columns;  // nodes, at most
  double zeros;
};
constexpr MergeRule kMergeRules[] = {{4, 1.0}, {12, 0.5}, {24, 0.2}, {64, 0.1}, {1 << 30, 0.04}};

// Adjacency lists of the free nodes, all as places in the elimination order.
struct Graph {
  std::vector<int> begin, neighbour;
};

Graph FreeGraph(const BlockPattern& pattern, const EliminationOrder& order) {
  Graph graph;
  graph.begin.push_back(0);
  for (const int node : order.node) {
    for (int k = pattern.row_begin[node]; k < pattern.row_begin[node + 1]; ++k) {
      const int place = order.place[pattern.column[k]];
      if (place >= 0 && pattern.column[k] != node) graph.neighbour.push_back(place);
    }
    graph.begin.push_back(static_cast<int>(graph.neighbour.size()));
  }
  return graph;
}

// parent[j] is the first row below the diagonal of column j of the factor (Liu 1986).
std::vector<int> EliminationTree(const Graph& graph) {
  const int n = static_cast<int>(graph.begin.size()) - 1;
  std::vector<int> parent(n, -1), ancestor(n, -1);
  for (int j = 0; j < n; ++j) {
    for (int k = graph.begin[j]; k < graph.begin[j + 1]; ++k) {
      int i = graph.neighbour[k];
      while (i < j && i >= 0 && ancestor[i] != j) {
        const int next = ancestor[i];
        ancestor[i] = j;
        if (next < 0) parent[i] = j;
        i = next;
      }
    }
  }
  return parent;
}

// The children of each node of a tree, ascending.
std::vector<std::vector<int>> Children(const std::vector<int>& parent) {
  std::vector<std::vector<int>> children(parent.size());
  for (size_t i = 0; i < parent.size(); ++i) {
    if (parent[i] >= 0) children[parent[i]].push_back(static_cast<int>(i));
  }
  return children;
}

// The nodes of a forest with each node after all of its descendants.
std::vector<int> Postorder(const std::vector<int>& parent) {
  const std::vector<std::vector<int>> children = Children(parent);
  std::vector<int> postorder;
  std::vector<std::pair<int, size_t>> path;  // node and the child to visit next
  for (size_t root = 0; root < parent.size(); ++root) {
    if (parent[root] >= 0) continue;
    path.emplace_back(static_cast<int>(root), 0);
    while (!path.empty()) {
      auto& [node, next] = path.back();
      if (next < children[node].size()) {
        path.emplace_back(children[node][next++], 0);
      } else {
        postorder.push_back(node);
        path.pop_back();
      }
    }
  }
  return postorder;
}

// The order in which the k-th node is number permutation[k] of `order`.
EliminationOrder Permuted(const EliminationOrder& order, const std::vector<int>& permutation) {
  EliminationOrder permuted = order;
  for (size_t k = 0; k < permutation.size(); ++k) {
    permuted.node[k] = order.node[permutation[k]];
    permuted.place[permuted.node[k]] = static_cast<int>(k);
  }
  return permuted;
}

// The number of rows below the diagonal in each column of the factor. Row i has an entry in the
// columns on the paths of the elimination tree from its neighbours up to i.
std::vector<int> ColumnCounts(const Graph& graph, const std::vector<int>& parent) {
  const int n = static_cast<int>(parent.size());
  std::vector<int> count(n, 0), visited_for(n, -1);
  for (int i = 0; i < n; ++i) {
    visited_for[i] = i;
    for (int k = graph.begin[i]; k < graph.begin[i + 1]; ++k) {
      for (int j = graph.neighbour[k]; j < i && visited_for[j] != i; j = parent[j]) {
        visited_for[j] = i;
        ++count[j];
      }
    }
  }
  return count;
}

// Supernodes as sets of columns of a postordered elimination tree.
struct Partition {
  std::vector<int> supernode_of;  // supernode of each column
  std::vector<int> parent;        // parent of each supernode; −1 for a root
  std::vector<int> columns;       // number of columns of each supernode
};

// Entries of the columns of a supernode, of which the upper `columns` rows form a triangle.
double TrapezoidEntries(double columns, double rows) {
  return 0.5 * columns * (columns + 1) + columns * rows;
}

// Whether a merged supernode with this number of columns, and of entries stored and not zero, is
// allowed by kMergeRules.
bool WorthMerging(double columns, double stored, double nonzero) {
  for (const MergeRule& rule : kMergeRules) {
    if (columns <= rule.columns) return stored - nonzero <= rule.zeros * stored;
  }
  return false;
}

// The fundamental supernodes: the longest sequences of columns of which each is the parent of the
// one before, with the same rows except for itself. `count` holds the rows below each column.
Partition FundamentalSupernodes(const std::vector<int>& parent, const std::vector<int>& count) {
  const int n = static_cast<int>(parent.size());
  Partition partition;
  partition.supernode_of.resize(n);
  for (int j = 0; j < n; ++j) {
    const bool continues = j > 0 && parent[j - 1] == j && count[j - 1] == count[j] + 1;
    if (!continues) partition.columns.push_back(0);
    partition.supernode_of[j] = static_cast<int>(partition.columns.size()) - 1;
    ++partition.columns.back();
  }
  partition.parent.assign(partition.columns.size(), -1);
  for (int j = 0; j < n; ++j) {
    const int s = partition.supernode_of[j];
    if (parent[j] >= 0 && partition.supernode_of[parent[j]] != s) {
      partition.parent[s] = partition.supernode_of[parent[j]];
    }
  }
  return partition;
}

// Decides bottom-up which fundamental supernodes are merged into their parents (Ashcraft & Grimes
// 1989). Each set of merged supernodes is represented by its topmost member. `count` holds the rows
// below each column.
DisjointSets MergedSupernodes(const Partition& partition, const std::vector<int>& count) {
  const int supernodes = static_cast<int>(partition.parent.size());
  std::vector<int> rows(supernodes);  // below all columns of a supernode, i.e. below its last one
  for (size_t j = 0; j < count.size(); ++j) rows[partition.supernode_of[j]] = count[j];
  std::vector<int> columns = partition.columns;
  std::vector<double> nonzero(supernodes);
  for (int s = 0; s < supernodes; ++s) nonzero[s] = TrapezoidEntries(columns[s], rows[s]);
  DisjointSets merged_into(static_cast<size_t>(supernodes));
  for (int child = 0; child < supernodes; ++child) {
    const int p = partition.parent[child];
    if (p < 0) continue;
    const double merged = columns[child] + columns[p];
    const double entries = nonzero[child] + nonzero[p];
    if (!WorthMerging(merged, TrapezoidEntries(merged, rows[p]), entries)) continue;
    merged_into.MergeInto(child, p);
    columns[p] += columns[child];
    nonzero[p] = entries;
  }
  return merged_into;
}

// The fundamental supernodes after merging, in the order of their topmost members.
Partition FindSupernodes(const std::vector<int>& parent, const std::vector<int>& count) {
  const Partition fundamental = FundamentalSupernodes(parent, count);
  DisjointSets merged_into = MergedSupernodes(fundamental, count);
  const int supernodes = static_cast<int>(fundamental.parent.size());
  Partition merged;
  std::vector<int> number(supernodes, -1);
  for (int s = 0; s < supernodes; ++s) {
    if (merged_into.Find(s) != s) continue;
    number[s] = static_cast<int>(merged.columns.size());
    merged.columns.push_back(0);
  }
  merged.parent.assign(merged.columns.size(), -1);
  for (int s = 0; s < supernodes; ++s) {
    const int own = number[merged_into.Find(s)];
    merged.columns[own] += fundamental.columns[s];
    if (number[s] >= 0 && fundamental.parent[s] >= 0)
      merged.parent[own] = number[merged_into.Find(fundamental.parent[s])];
  }
  for (const int s : fundamental.supernode_of)
    merged.supernode_of.push_back(number[merged_into.Find(s)]);
  return merged;
}

// Sets the update rows of all supernodes. Those of a supernode are the later neighbours of its
// columns and the update rows of its children that are not among its columns.
void FindRows(const Graph& graph, AssemblyTree* tree) {
  const int supernodes = tree->SupernodeCount();
  std::vector<int> seen_by(tree->order.FreeNodes(), -1);
  tree->row_begin.assign(1, 0);
  for (int s = 0; s < supernodes; ++s) {
    const int end = tree->column_begin[s + 1];
    const auto add = [&](int row) {
      if (row < end || seen_by[row] == s) return;
      seen_by[row] = s;
      tree->row.push_back(row);
    };
    for (int j = tree->column_begin[s]; j < end; ++j) {
      for (int k = graph.begin[j]; k < graph.begin[j + 1]; ++k) add(graph.neighbour[k]);
    }
    for (const int child : tree->children[s]) {
      for (int k = tree->row_begin[child]; k < tree->row_begin[child + 1]; ++k) add(tree->row[k]);
    }
    std::sort(tree->row.begin() + tree->row_begin[s], tree->row.end());
    tree->row_begin.push_back(static_cast<int>(tree->row.size()));
  }
}

// The runs of the update rows of supernode s in the front of its parent; none for a root.
std::vector<RowRun> RunsIntoParent(const AssemblyTree& tree, int s) {
  std::vector<RowRun> runs;
  const int p = tree.parent[s];
  if (p < 0) return runs;
  int at = tree.row_begin[p];
  for (int k = tree.row_begin[s]; k < tree.row_begin[s + 1]; ++k) {
    const int row = tree.row[k];
    int to = row - tree.column_begin[p];
    if (row >= tree.column_begin[p + 1]) {
      while (tree.row[at] < row) ++at;
      to = tree.Columns(p) + at - tree.row_begin[p];
    }
    if (!runs.empty() && runs.back().to + runs.back().length == to) {
      ++runs.back().length;
    } else {
      runs.push_back({k - tree.row_begin[s], to, 1});
    }
  }
  return runs;
}

// The supernodes of a partition in postorder, with their columns made consecutive, which they no
// longer are after merging. `order` is that of the columns of the partition. Update rows and runs
// are not set.
AssemblyTree PostorderedTree(const Partition& partition, const EliminationOrder& order) {
  const std::vector<int> supernode_order = Postorder(partition.parent);
  const int supernodes = static_cast<int>(supernode_order.size());
  std::vector<int> number(supernodes);
  for (int k = 0; k < supernodes; ++k) number[supernode_order[k]] = k;

  AssemblyTree tree;
  tree.parent.assign(supernodes, -1);
  tree.column_begin.assign(supernodes + 1, 0);
  for (int s = 0; s < supernodes; ++s) {
    if (partition.parent[s] >= 0) tree.parent[number[s]] = number[partition.parent[s]];
    tree.column_begin[number[s] + 1] = partition.columns[s];
  }
  tree.children = Children(tree.parent);
  std::partial_sum(tree.column_begin.begin(), tree.column_begin.end(), tree.column_begin.begin());
  std::vector<int> next(tree.column_begin.begin(), tree.column_begin.end() - 1);
  std::vector<int> gathered(partition.supernode_of.size());
  for (size_t j = 0; j < gathered.size(); ++j) {
    gathered[next[number[partition.supernode_of[j]]]++] = static_cast<int>(j);
  }
  tree.order = Permuted(order, gathered);
  return tree;
}

}  // namespace

AssemblyTree MakeAssemblyTree(const BlockPattern& pattern, const EliminationOrder& order) {
  const EliminationOrder postordered =
      Permuted(order, Postorder(EliminationTree(FreeGraph(pattern, order))));
  const Graph graph = FreeGraph(pattern, postordered);
  const std::vector<int> column_parent = EliminationTree(graph);
  const Partition partition = FindSupernodes(column_parent, ColumnCounts(graph, column_parent));
  AssemblyTree tree = PostorderedTree(partition, postordered);
  FindRows(FreeGraph(pattern, tree.order), &tree);
  for (int s = 0; s < tree.SupernodeCount(); ++s) tree.runs.push_back(RunsIntoParent(tree, s));
  return tree;
}

TreeCut CutTree(const AssemblyTree& tree, const std::vector<double>& cost) {
  const int supernodes = tree.SupernodeCount();
  CHECK_EQ(cost.size(), static_cast<size_t>(supernodes));
  std::vector<double> below = cost;
  std::vector<int> first(supernodes);  // first supernode of the subtree below s
  double total = 0;
  for (int s = 0; s < supernodes; ++s) {
    first[s] = tree.children[s].empty() ? s : first[tree.children[s].front()];
    if (tree.parent[s] >= 0) below[tree.parent[s]] += below[s];
    total += cost[s];
  }
  TreeCut cut;
  for (int s = supernodes - 1; s >= 0;) {
    if (below[s] > kLargestSubtree * total && !tree.children[s].empty()) {
      cut.top.push_back(s--);
    } else {
      cut.subtrees.push_back({first[s], s + 1});
      s = first[s] - 1;
    }
  }
  std::reverse(cut.top.begin(), cut.top.end());
  std::stable_sort(cut.subtrees.begin(), cut.subtrees.end(), [&](const auto& a, const auto& b) {
    return below[a.end - 1] > below[b.end - 1];
  });
  return cut;
}

}  // namespace lacuna
