#include "fem/supernodal_factor.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "core/memory_limit.h"
#include "core/parallel.h"

namespace lacuna {
namespace {

constexpr int kNodesPerTask = 256;  // columns of a child, in nodes, that are added per task

// Floating-point operations of the elimination of p out of m columns of a front.
double EliminationFlops(double m, double p) {
  const double u = m - p;
  return p * p * p / 3 + p * p * u + p * u * u;
}

}  // namespace

SupernodalFactor::SupernodalFactor(const BlockPattern& pattern, const EliminationOrder& order)
    : tree_(MakeAssemblyTree(pattern, order)) {
  const int supernodes = tree_.SupernodeCount();
  std::vector<double> cost(supernodes);
  for (int s = 0; s < supernodes; ++s) {
    const double m = 3.0 * tree_.FrontRows(s), p = 3.0 * tree_.Columns(s);
    flops_ += EliminationFlops(m, p);
    // Memory traffic makes small fronts slower per operation than large ones.
    cost[s] = EliminationFlops(m, p) + 50 * m * m;
  }
  cut_ = CutTree(tree_, cost);

  std::vector<int> place_in_front(tree_.order.FreeNodes(), -1);
  entry_begin_.assign(1, 0);
  for (int s = 0; s < supernodes; ++s) {
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
  PlaceInMemory();
}

// In a postordered tree, update matrices are used in the order of stacks, one for the even and one
// for the odd levels: when a front is assembled, the updates of its children are on top of one
// stack, and its own update is pushed onto the other. Each subtree of the cut has two stacks of its
// own.
void SupernodalFactor::PlaceInMemory() {
  const int supernodes = tree_.SupernodeCount();
  std::vector<int> level(supernodes, 0);
  for (int s = supernodes - 1; s >= 0; --s) {
    if (tree_.parent[s] >= 0) level[s] = level[tree_.parent[s]] + 1;
  }
  std::vector<int> region(supernodes, -1);
  for (size_t t = 0; t < cut_.subtrees.size(); ++t) {
    for (int s = cut_.subtrees[t].begin; s < cut_.subtrees[t].end; ++s) {
      region[s] = static_cast<int>(t);
    }
  }
  for (const int s : cut_.top) region[s] = static_cast<int>(cut_.subtrees.size());

  struct Stack {
    int64_t height = 0, highest = 0;
  };
  std::vector<Stack> stacks(2 * (cut_.subtrees.size() + 1));
  const auto stack_of = [&](int s) -> Stack& { return stacks[2 * region[s] + level[s] % 2]; };
  const auto update_size = [&](int s) {
    const int64_t rows = 3 * tree_.UpdateRows(s);
    return rows * rows;
  };

  panel_begin_.assign(1, 0);
  vector_begin_.assign(1, 0);
  update_begin_.resize(supernodes);
  for (int s = 0; s < supernodes; ++s) {
    const int64_t m = 3 * tree_.FrontRows(s), p = 3 * tree_.Columns(s);
    panel_begin_.push_back(panel_begin_.back() + m * p);
    vector_begin_.push_back(vector_begin_.back() + m);
    for (const int child : tree_.children[s]) {
      if (region[child] == region[s]) stack_of(child).height -= update_size(child);
    }
    Stack& stack = stack_of(s);
    update_begin_[s] = stack.height;
    stack.height += update_size(s);
    stack.highest = std::max(stack.highest, stack.height);
  }
  int64_t base = 0;
  for (Stack& stack : stacks) {
    stack.height = base;
    base += stack.highest;
  }
  for (int s = 0; s < supernodes; ++s) update_begin_[s] += stack_of(s).height;
  RequireMemory(
      sizeof(float) * static_cast<double>(panel_begin_.back() + base),
      fmt::format("the factor of a stiffness matrix of {} unknowns", 3 * order().node.size()),
      kCoarserMesh);
  factor_.assign(panel_begin_.back(), 0.0f);
  updates_.assign(base, 0.0f);
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
  float* panel = &factor_[panel_begin_[s]];
  float* update = updates_.data() + update_begin_[s];
  std::fill(panel, panel + m * p, 0.0f);
  std::fill(update, update + u * u, 0.0f);
  for (int64_t k = entry_begin_[s]; k < entry_begin_[s + 1]; ++k) {
    const Entry& entry = entries_[k];
    // The matrix stores the transposed block, in row `column`.
    const Eigen::Matrix3f block = (scale_ * matrix.Block(entry.block).transpose()).cast<float>();
    Eigen::Map<Eigen::Matrix3f, 0, Eigen::OuterStride<>>(
        panel + 3 * entry.row + 3 * entry.column * m, Eigen::OuterStride<>(m)) = block;
  }
  for (const int child : tree_.children[s]) {
    const int64_t rows = 3 * tree_.UpdateRows(child);
    const float* source = updates_.data() + update_begin_[child];
    const std::vector<RowRun>& runs = tree_.runs[child];
    ParallelBlocks(tree_.UpdateRows(child), kNodesPerTask, [&](int64_t begin, int64_t end) {
      size_t first = 0;
      while (runs[first].from + runs[first].length <= begin) ++first;
      for (int64_t node = begin; node < end; ++node) {
        if (node == runs[first].from + runs[first].length) ++first;
        const int64_t place = runs[first].to + node - runs[first].from;
        for (int64_t c = 0; c < 3; ++c) {
          const float* from = source + (3 * node + c) * rows;
          const int64_t column = 3 * place + c;
          // `to` refers to row 0 of the front; an update matrix begins at row p.
          float* to = column < p ? panel + column * m : update + (column - p) * u - p;
          for (size_t r = first; r < runs.size(); ++r) {
            const int64_t skipped = r == first ? node - runs[r].from : 0;
            const int64_t length = 3 * (runs[r].length - skipped);
            const float* run_from = from + 3 * (runs[r].from + skipped);
            float* run_to = to + 3 * (runs[r].to + skipped);
            for (int64_t i = 0; i < length; ++i) run_to[i] += run_from[i];
          }
        }
      }
    });
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
