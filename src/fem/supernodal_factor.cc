#include "fem/supernodal_factor.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/memory_limit.h"
#include "core/parallel.h"

namespace lacuna {
namespace {

constexpr int kUpdateNodesPerTask = 256;  // columns of a child, in nodes, that are added per task

// Floating-point operations of the elimination of p out of m columns of a front.
double EliminationFlops(double m, double p) {
  const double u = m - p;
  return p * p * p / 3 + p * p * u + p * u * u;
}

// The number of edges from each supernode up to its root.
std::vector<int> Levels(const AssemblyTree& tree) {
  std::vector<int> level(tree.SupernodeCount(), 0);
  for (int s = tree.SupernodeCount() - 1; s >= 0; --s) {
    if (tree.parent[s] >= 0) level[s] = level[tree.parent[s]] + 1;
  }
  return level;
}

// The subtree of the cut to which each supernode belongs; for those above the cut, the number of
// subtrees.
std::vector<int> Regions(const AssemblyTree& tree, const TreeCut& cut) {
  std::vector<int> region(tree.SupernodeCount(), -1);
  for (size_t t = 0; t < cut.subtrees.size(); ++t) {
    for (int s = cut.subtrees[t].begin; s < cut.subtrees[t].end; ++s) {
      region[s] = static_cast<int>(t);
    }
  }
  for (const int s : cut.top) region[s] = static_cast<int>(cut.subtrees.size());
  return region;
}

// Where the update matrices are stored, as indices into one array of numbers.
struct UpdatePlaces {
  std::vector<int64_t> begin;  // of each supernode
  int64_t size = 0;            // of the array
};

// In a postordered tree, update matrices are used in the order of stacks, one for the even and one
// for the odd levels: when a front is assembled, the updates of its children are on top of one
// stack, and its own update is pushed onto the other. Each subtree of the cut has two stacks of its
// own, and so have the supernodes above it.
UpdatePlaces PlaceUpdates(const AssemblyTree& tree, const TreeCut& cut) {
  struct Stack {
    int64_t height = 0, highest = 0;
  };
  const std::vector<int> level = Levels(tree), region = Regions(tree, cut);
  std::vector<Stack> stacks(2 * (cut.subtrees.size() + 1));
  const auto stack_of = [&](int s) { return static_cast<size_t>(2 * region[s] + level[s] % 2); };
  const auto size_of = [&](int s) {
    const int64_t rows = 3 * tree.UpdateRows(s);
    return rows * rows;
  };

  UpdatePlaces places;
  for (int s = 0; s < tree.SupernodeCount(); ++s) {
    for (const int child : tree.children[s]) {
      if (region[child] == region[s]) stacks[stack_of(child)].height -= size_of(child);
    }
    Stack& stack = stacks[stack_of(s)];
    places.begin.push_back(stack.height);
    stack.height += size_of(s);
    stack.highest = std::max(stack.highest, stack.height);
  }
  // The stacks are stored one after another.
  std::vector<int64_t> base;
  for (const Stack& stack : stacks) {
    base.push_back(places.size);
    places.size += stack.highest;
  }
  for (int s = 0; s < tree.SupernodeCount(); ++s) places.begin[s] += base[stack_of(s)];
  return places;
}

// A dense front (dense_front.h).
struct Front {
  int64_t m = 0, p = 0;  // rows, of which the first p are eliminated
  float* panel = nullptr;
  float* update = nullptr;

  // The address of row 0 of a column. Of the columns from p on, which form the update matrix, only
  // the rows from p on are stored.
  float* Column(int64_t column) const {
    return column < p ? panel + column * m : update + (column - p) * (m - p) - p;
  }
};

// Adds the part of a column of a child's update matrix from row 3·`node` on to a column of the
// front of the parent. `run` is the run that contains the node, and `end` the end of the runs.
void AddColumn(const float* from, int64_t node, const RowRun* run, const RowRun* end, float* to) {
  for (int64_t skipped = node - run->from; run != end; ++run, skipped = 0) {
    const int64_t length = 3 * (run->length - skipped);
    const float* run_from = from + 3 * (run->from + skipped);
    float* run_to = to + 3 * (run->to + skipped);
    for (int64_t i = 0; i < length; ++i) run_to[i] += run_from[i];
  }
}

// Adds the lower triangle of a child's update matrix of `nodes` block rows to the front of the
// parent.
void AddUpdate(const float* update, int nodes, const std::vector<RowRun>& runs,
               const Front& front) {
  const int64_t rows = 3 * nodes;
  ParallelBlocks(nodes, kUpdateNodesPerTask, [&](int64_t begin, int64_t end) {
    const RowRun* run = runs.data();
    while (run->from + run->length <= begin) ++run;
    for (int64_t node = begin; node < end; ++node) {
      if (node == run->from + run->length) ++run;
      const int64_t place = run->to + node - run->from;
      for (int64_t c = 0; c < 3; ++c) {
        AddColumn(update + (3 * node + c) * rows, node, run, runs.data() + runs.size(),
                  front.Column(3 * place + c));
      }
    }
  });
}

}  // namespace

SupernodalFactor::SupernodalFactor(const BlockPattern& pattern, const EliminationOrder& order)
    : tree_(MakeAssemblyTree(pattern, order)) {
  std::vector<double> cost(tree_.SupernodeCount());
  for (int s = 0; s < tree_.SupernodeCount(); ++s) {
    const double m = 3.0 * tree_.FrontRows(s), p = 3.0 * tree_.Columns(s);
    flops_ += EliminationFlops(m, p);
    // Memory traffic makes small fronts slower per operation than large ones.
    cost[s] = EliminationFlops(m, p) + 50 * m * m;
  }
  cut_ = CutTree(tree_, cost);
  ListEntries(pattern);
  PlaceInMemory();
}

void SupernodalFactor::ListEntries(const BlockPattern& pattern) {
  std::vector<int> place_in_front(tree_.order.FreeNodes(), -1);
  entry_begin_.assign(1, 0);
  for (int s = 0; s < tree_.SupernodeCount(); ++s) {
    const int begin = tree_.column_begin[s], columns = tree_.Columns(s);
    for (int k = tree_.row_begin[s]; k < tree_.row_begin[s + 1]; ++k) {
      place_in_front[tree_.row[k]] = columns + k - tree_.row_begin[s];
    }
    for (int j = 0; j < columns; ++j) {
      const int node = tree_.order.node[begin + j];
      for (int k = pattern.row_begin[node]; k < pattern.row_begin[node + 1]; ++k) {
        const int place = tree_.order.place[pattern.column[k]];
        if (place < begin + j) continue;
        const int row = place < begin + columns ? place - begin : place_in_front[place];
        entries_.push_back({k, row, j});
      }
    }
    entry_begin_.push_back(static_cast<int64_t>(entries_.size()));
  }
}

void SupernodalFactor::PlaceInMemory() {
  panel_begin_.assign(1, 0);
  vector_begin_.assign(1, 0);
  for (int s = 0; s < tree_.SupernodeCount(); ++s) {
    const int64_t m = 3 * tree_.FrontRows(s), p = 3 * tree_.Columns(s);
    panel_begin_.push_back(panel_begin_.back() + m * p);
    vector_begin_.push_back(vector_begin_.back() + m);
  }
  UpdatePlaces updates = PlaceUpdates(tree_, cut_);
  update_begin_ = std::move(updates.begin);
  RequireMemory(
      sizeof(float) * static_cast<double>(panel_begin_.back() + updates.size),
      fmt::format("the factor of a stiffness matrix of {} unknowns", 3 * order().node.size()),
      kCoarserMesh);
  factor_.assign(panel_begin_.back(), 0.0f);
  updates_.assign(updates.size, 0.0f);
  front_vectors_.assign(vector_begin_.back(), 0.0f);
}

template <typename Visit>
void SupernodalFactor::VisitUpwards(const Visit& visit) const {
  ParallelFor(static_cast<int64_t>(cut_.subtrees.size()), 1, [&](int64_t t) {
    for (int s = cut_.subtrees[t].begin; s < cut_.subtrees[t].end; ++s) visit(s);
  });
  for (const int s : cut_.top) visit(s);
}

template <typename Visit>
void SupernodalFactor::VisitDownwards(const Visit& visit) const {
  for (auto s = cut_.top.rbegin(); s != cut_.top.rend(); ++s) visit(*s);
  ParallelFor(static_cast<int64_t>(cut_.subtrees.size()), 1, [&](int64_t t) {
    for (int s = cut_.subtrees[t].end - 1; s >= cut_.subtrees[t].begin; --s) visit(s);
  });
}

void SupernodalFactor::AssembleFront(int s, const BlockMatrix& matrix) {
  const int64_t m = 3 * tree_.FrontRows(s), p = 3 * tree_.Columns(s), u = m - p;
  const Front front{m, p, &factor_[panel_begin_[s]], updates_.data() + update_begin_[s]};
  std::fill(front.panel, front.panel + m * p, 0.0f);
  std::fill(front.update, front.update + u * u, 0.0f);
  for (int64_t k = entry_begin_[s]; k < entry_begin_[s + 1]; ++k) {
    const Entry& entry = entries_[k];
    // The matrix stores the transposed block, in row `column`.
    const Eigen::Matrix3f block = (scale_ * matrix.Block(entry.block).transpose()).cast<float>();
    Eigen::Map<Eigen::Matrix3f, 0, Eigen::OuterStride<>>(
        front.panel + 3 * entry.row + 3 * entry.column * m, Eigen::OuterStride<>(m)) = block;
  }
  for (const int child : tree_.children[s]) {
    AddUpdate(updates_.data() + update_begin_[child], tree_.UpdateRows(child), tree_.runs[child],
              front);
  }
}

Pivots SupernodalFactor::EliminateFront(int s, const BlockMatrix& matrix) {
  AssembleFront(s, matrix);
  return EliminateColumns(3 * tree_.FrontRows(s), 3 * tree_.Columns(s), &factor_[panel_begin_[s]],
                          updates_.data() + update_begin_[s]);
}

Pivots SupernodalFactor::Factorise(const BlockMatrix& matrix) {
  double largest = 0;
  for (const int node : tree_.order.node) {
    largest = std::max(largest, matrix.Block(matrix.pattern().diagonal[node]).trace());
  }
  if (!(largest > 0) || !std::isfinite(largest)) return Pivots::kInDoubt;
  scale_ = std::exp2(-std::ilogb(largest));
  // Fronts above a failed one are skipped and all others are attempted, so that the result does not
  // depend on which thread failed first.
  std::vector<Pivots> pivots(tree_.SupernodeCount(), Pivots::kPositive);
  VisitUpwards([&](int s) {
    for (const int child : tree_.children[s]) pivots[s] = std::max(pivots[s], pivots[child]);
    if (pivots[s] == Pivots::kPositive) pivots[s] = EliminateFront(s, matrix);
  });
  return pivots.empty() ? Pivots::kPositive : *std::max_element(pivots.begin(), pivots.end());
}

void SupernodalFactor::SolveForward(int s, const float* b) {
  const int p = 3 * tree_.Columns(s), m = 3 * tree_.FrontRows(s);
  float* y = &front_vectors_[vector_begin_[s]];
  std::copy_n(b + 3 * tree_.column_begin[s], p, y);
  std::fill(y + p, y + m, 0.0f);
  for (const int child : tree_.children[s]) {
    const float* passed = &front_vectors_[vector_begin_[child]] + 3 * tree_.Columns(child);
    for (const RowRun& run : tree_.runs[child]) {
      for (int i = 0; i < 3 * run.length; ++i) y[3 * run.to + i] += passed[3 * run.from + i];
    }
  }
  ForwardSubstitute(m, p, &factor_[panel_begin_[s]], y);
}

void SupernodalFactor::SolveBackward(int s, float* x) {
  const int p = 3 * tree_.Columns(s), m = 3 * tree_.FrontRows(s);
  float* y = &front_vectors_[vector_begin_[s]];
  for (int k = 0; k < tree_.UpdateRows(s); ++k) {
    std::copy_n(x + 3 * tree_.row[tree_.row_begin[s] + k], 3, y + p + 3 * k);
  }
  BackwardSubstitute(m, p, &factor_[panel_begin_[s]], y);
  std::copy_n(y, p, x + 3 * tree_.column_begin[s]);
}

void SupernodalFactor::Solve(const Eigen::VectorXf& b, Eigen::VectorXf* x) {
  CHECK_EQ(b.size(), 3 * tree_.order.FreeNodes());
  x->resize(b.size());
  VisitUpwards([&](int s) { SolveForward(s, b.data()); });
  VisitDownwards([&](int s) { SolveBackward(s, x->data()); });
  *x *= scale_;
}

}  // namespace lacuna
