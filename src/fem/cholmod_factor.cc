#include "fem/cholmod_factor.h"

#include <glog/logging.h>
#include <suitesparse/cholmod.h>

#include <algorithm>
#include <utility>
#include <vector>

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

}  // namespace

struct CholmodFactor::Implementation {
  cholmod_common common;
  LowerTriangle lower;
  std::vector<double> values;
  cholmod_sparse matrix = {};
  cholmod_factor* factor = nullptr;
  cholmod_dense *solution = nullptr, *workspace_y = nullptr, *workspace_e = nullptr;
  double flops = 0, entries = 0;

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
  ~Implementation() {
    cholmod_free_factor(&factor, &common);
    cholmod_free_dense(&solution, &common);
    cholmod_free_dense(&workspace_y, &common);
    cholmod_free_dense(&workspace_e, &common);
    cholmod_finish(&common);
  }
};

CholmodFactor::CholmodFactor(const BlockPattern& pattern, const EliminationOrder& order)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  self.lower = LowerTriangleOf(pattern, order);
  self.values.assign(self.lower.row.size(), 0.0);
  self.matrix.nrow = self.matrix.ncol = 3 * static_cast<size_t>(order.FreeNodes());
  self.matrix.nzmax = self.values.size();
  self.matrix.p = self.lower.begin.data();
  self.matrix.i = self.lower.row.data();
  self.matrix.x = self.values.data();
  self.matrix.stype = -1;
  self.matrix.itype = CHOLMOD_INT;
  self.matrix.xtype = CHOLMOD_REAL;
  self.matrix.dtype = CHOLMOD_DOUBLE;
  self.matrix.sorted = self.matrix.packed = true;
  self.factor = cholmod_analyze(&self.matrix, &self.common);
  CHECK(self.factor != nullptr) << "CHOLMOD's symbolic analysis failed with status "
                                << self.common.status;
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
  const SerialOpenMp serial;
  cholmod_factorize(&self.matrix, self.factor, &self.common);
  CHECK_GE(self.common.status, CHOLMOD_OK) << "CHOLMOD could not factorise (out of memory?)";
  // CHOLMOD factorises a matrix with NaN without an error; the condition number reveals it.
  return self.common.status == CHOLMOD_OK && self.factor->minor == self.factor->n &&
         (self.matrix.nrow == 0 || cholmod_rcond(self.factor, &self.common) > 0);
}

void CholmodFactor::Solve(const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::MatrixXd* X) {
  Implementation& self = *implementation_;
  CHECK_EQ(static_cast<size_t>(B.rows()), self.matrix.nrow);
  X->resize(B.rows(), B.cols());
  if (B.size() == 0) return;  // CHOLMOD rejects an empty matrix
  cholmod_dense right = {};
  right.nrow = self.matrix.nrow;
  right.d = B.outerStride();
  right.ncol = B.cols();
  right.nzmax = right.d * right.ncol;
  right.x = const_cast<double*>(B.data());
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;
  const int solved = cholmod_solve2(CHOLMOD_A, self.factor, &right, nullptr, &self.solution,
                                    nullptr, &self.workspace_y, &self.workspace_e, &self.common);
  CHECK(solved) << "CHOLMOD's triangular solve failed with status " << self.common.status;
  *X = Eigen::Map<const Eigen::MatrixXd>(static_cast<const double*>(self.solution->x), B.rows(),
                                         B.cols());
}

double CholmodFactor::flops() const { return implementation_->flops; }
double CholmodFactor::entries() const { return implementation_->entries; }

}  // namespace lacuna
