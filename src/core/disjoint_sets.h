// A partition of the integers 0 … count − 1 into sets that can be merged (union-find, with paths
// halved; Tarjan & van Leeuwen 1984).
#ifndef LACUNA_CORE_DISJOINT_SETS_H_
#define LACUNA_CORE_DISJOINT_SETS_H_

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace lacuna {

// Each set is represented by one of its elements. At first every integer is a set of its own.
// Integers outside the range are not caught.
class DisjointSets {
 public:
  explicit DisjointSets(size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  // The representative of the set of i.
  int Find(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  // Merges the sets of i and j. The smaller of their two representatives represents the result, so
  // that after calls of Merge() alone it is the smallest element of its set.
  void Merge(int i, int j) {
    const int root_i = Find(i), root_j = Find(j);
    parent_[std::max(root_i, root_j)] = std::min(root_i, root_j);
  }

  // Merges the set of i into that of j, whose representative represents the result.
  void MergeInto(int i, int j) { parent_[Find(i)] = Find(j); }

 private:
  std::vector<int> parent_;
};

}  // namespace lacuna

#endif  // LACUNA_CORE_DISJOINT_SETS_H_
