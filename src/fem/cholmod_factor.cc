#include "fem/cholmod_factor.h"

#include <fmt/format.h>
#include <glog/logging.h>
#include <suitesparse/cholmod.h>

#include <algorithm>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

#include "core/memory_limit.h"
#include "core/serial_openmp.h"

namespace lacuna {
namespace {

// The lower triangle in elimination order, in compressed columns. `source` is the place of each
// entry among the values of the block matrix.
struct LowerTriangle {
  std::vector<int> begin, row, source;
};

LowerTriangle LowerTriangleOf(const BlockPattern& pattern, const EliminationOrder& order) {
  LowerTriangle lower;
  lower.begin.push_back(0);
  std::vector<std::pair<int, int>> blocks;  // place of the row, position in the pattern
  for (int j = 0; j < order.FreeNodes(); ++j) {
    const int node = order.node[j];
    blocks.clear();
    for (int k = pattern.row_begin[node]; k < pattern.row_begin[node + 1]; ++k) {
      const int i = order.place[pattern.column[k]];
      if (i >= j) blocks.emplace_back(i, k);
    }
    std::sort(blocks.begin(), blocks.end());
    for (int c = 0; c < 3; ++c) {
      for (const auto& [i, k] : blocks) {
        for (int r = i == j ? c : 0; r < 3; ++r) {
          lower.row.push_back(3 * i + r);
          // The block of column j is the transpose of a block in row `node`.
          lower.source.push_back(9 * k + 3 * r + c);
        }
      }
      lower.begin.push_back(static_cast<int>(lower.row.size()));
    }
  }
  return lower;
}

// The same matrix with its rows and columns in the order `pivots`.
LowerTriangle Reordered(const LowerTriangle& lower, const std::vector<int>& pivots) {
  const int size = static_cast<int>(pivots.size());
  std::vector<int> place(pivots.size());
  for (int k = 0; k < size; ++k) place[pivots[k]] = k;
  std::vector<std::vector<std::pair<int, int>>> columns(pivots.size());  // row, source
  for (int j = 0; j < size; ++j) {
    for (int k = lower.begin[j]; k < lower.begin[j + 1]; ++k) {
      const auto [col, row] = std::minmax(place[lower.row[k]], place[j]);
      columns[col].emplace_back(row, lower.source[k]);
    }
  }
  LowerTriangle reordered;
  reordered.begin.push_back(0);
  for (auto& column : columns) {
    std::sort(column.begin(), column.end());
    for (const auto& [row, source] : column) {
      reordered.row.push_back(row);
      reordered.source.push_back(source);
    }
    reordered.begin.push_back(static_cast<int>(reordered.row.size()));
  }
  return reordered;
}

// What one solution with a factor needs, and the next one uses again.
struct SolveWorkspace {
  cholmod_common common;
  Eigen::MatrixXd ordered_right;
  cholmod_dense *solution = nullptr, *y = nullptr, *e = nullptr;

  SolveWorkspace() {
    cholmod_start(&common);
    common.print = 0;
  }
  SolveWorkspace(const SolveWorkspace&) = delete;
  SolveWorkspace& operator=(const SolveWorkspace&) = delete;
  ~SolveWorkspace() {
    cholmod_free_dense(&solution, &common);
    cholmod_free_dense(&y, &common);
    cholmod_free_dense(&e, &common);
    cholmod_finish(&common);
  }
};

}  // namespace

struct CholmodFactor::Implementation {
  cholmod_common common;
  LowerTriangle lower;
  std::vector<int> pivots;  // the elimination order that CHOLMOD prefers, of scalar rows
  std::vector<double> values;
  cholmod_sparse matrix = {};
  cholmod_factor* factor = nullptr;
  double flops = 0, entries = 0;
  std::mutex mutex;  // protects `idle`
  std::vector<std::unique_ptr<SolveWorkspace>> idle;

  Implementation() {
    cholmod_start(&common);
    common.print = 0;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_NATURAL;
    common.postorder = true;
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  // The symbolic analysis of `lower`.
  void Analyse() {
    values.assign(lower.row.size(), 0.0);
    matrix.nrow = matrix.ncol = lower.begin.size() - 1;
    matrix.nzmax = values.size();
    matrix.p = lower.begin.data();
    matrix.i = lower.row.data();
    matrix.x = values.data();
    matrix.stype = -1;
    matrix.itype = CHOLMOD_INT;
    matrix.xtype = CHOLMOD_REAL;
    matrix.dtype = CHOLMOD_DOUBLE;
    matrix.sorted = matrix.packed = true;
    cholmod_free_factor(&factor, &common);
    factor = cholmod_analyze(&matrix, &common);
    if (common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    CHECK(factor != nullptr) << "CHOLMOD's symbolic analysis failed with status " << common.status;
  }

  std::unique_ptr<SolveWorkspace> TakeWorkspace() {
    const std::lock_guard lock(mutex);
    if (idle.empty()) return std::make_unique<SolveWorkspace>();
    std::unique_ptr<SolveWorkspace> workspace = std::move(idle.back());
    idle.pop_back();
    return workspace;
  }

  void ReturnWorkspace(std::unique_ptr<SolveWorkspace> workspace) {
    const std::lock_guard lock(mutex);
    idle.push_back(std::move(workspace));
  }

  ~Implementation() {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
};

CholmodFactor::CholmodFactor(const BlockPattern& pattern, const EliminationOrder& order)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  self.lower = LowerTriangleOf(pattern, order);
  self.Analyse();
  // Given the matrix in the order of the pivots, CHOLMOD need not transpose it at each
  // factorisation.
  const int* pivots = static_cast<const int*>(self.factor->Perm);
  self.pivots.assign(pivots, pivots + self.matrix.nrow);
  self.lower = Reordered(self.lower, self.pivots);
  self.common.postorder = false;
  self.Analyse();
  self.flops = self.common.fl;
  self.entries = self.common.lnz;
}

CholmodFactor::~CholmodFactor() = default;
CholmodFactor::CholmodFactor(CholmodFactor&&) noexcept = default;
CholmodFactor& CholmodFactor::operator=(CholmodFactor&&) noexcept = default;

bool CholmodFactor::Factorise(const BlockMatrix& matrix) {
  Implementation& self = *implementation_;
  const double* values = matrix.values();
  for (size_t k = 0; k < self.values.size(); ++k) self.values[k] = values[self.lower.source[k]];
  if (self.factor->xtype == CHOLMOD_PATTERN)  // memory is taken now
    RequireMemory(sizeof(double) * static_cast<double>(self.factor->xsize),
                  fmt::format("the factor of a stiffness matrix of {} unknowns", self.matrix.nrow),
                  kCoarserMesh);
  const SerialOpenMp serial;
  cholmod_factorize(&self.matrix, self.factor, &self.common);
  if (self.common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
  CHECK_GE(self.common.status, CHOLMOD_OK) << "CHOLMOD could not factorise";
  // CHOLMOD factorises a matrix with NaN without an error; the condition number reveals it.
  return self.common.status == CHOLMOD_OK && self.factor->minor == self.factor->n &&
         (self.matrix.nrow == 0 || cholmod_rcond(self.factor, &self.common) > 0);
}

void CholmodFactor::Solve(const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::MatrixXd* X) const {
  Implementation& self = *implementation_;
  CHECK_EQ(static_cast<size_t>(B.rows()), self.matrix.nrow);
  X->resize(B.rows(), B.cols());
  if (B.size() == 0) return;  // CHOLMOD rejects an empty matrix
  std::unique_ptr<SolveWorkspace> workspace = self.TakeWorkspace();
  SolveWorkspace& work = *workspace;
  work.ordered_right.resize(B.rows(), B.cols());
  for (Eigen::Index c = 0; c < B.cols(); ++c)
    for (Eigen::Index k = 0; k < B.rows(); ++k)
      work.ordered_right(k, c) = B(self.pivots[static_cast<size_t>(k)], c);
  cholmod_dense right = {};
  right.nrow = self.matrix.nrow;
  right.d = right.nrow;
  right.ncol = B.cols();
  right.nzmax = right.d * right.ncol;
  right.x = work.ordered_right.data();
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;
  const int solved = cholmod_solve2(CHOLMOD_A, self.factor, &right, nullptr, &work.solution,
                                    nullptr, &work.y, &work.e, &work.common);
  if (work.common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
  CHECK(solved) << "CHOLMOD's triangular solve failed with status " << work.common.status;
  const double* solution = static_cast<const double*>(work.solution->x);
  for (Eigen::Index c = 0; c < B.cols(); ++c)
    for (Eigen::Index k = 0; k < B.rows(); ++k)
      (*X)(self.pivots[static_cast<size_t>(k)], c) = solution[c * B.rows() + k];
  self.ReturnWorkspace(std::move(workspace));
}

double CholmodFactor::flops() const { return implementation_->flops; }
double CholmodFactor::entries() const { return implementation_->entries; }

}  // namespace lacuna
