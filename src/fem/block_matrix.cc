#include "fem/block_matrix.h"

#include <glog/logging.h>

#include <algorithm>

#include "core/parallel.h"
#include "fem/target_clones.h"

namespace lacuna {
namespace {

constexpr int kRowsPerBlock = 1024;

// elements[begin[i] … begin[i + 1]) are the elements of node i, ascending.
struct NodeElements {
  std::vector<int> begin, elements;
};

NodeElements ElementsOfNodes(int nodes, const Eigen::MatrixXi& elements) {
  NodeElements of;
  of.begin.assign(nodes + 1, 0);
  for (Eigen::Index k = 0; k < elements.size(); ++k) {
    const int node = elements.data()[k];
    CHECK(node >= 0 && node < nodes) << "an element refers to node " << node << " of " << nodes;
    ++of.begin[node + 1];
  }
  for (int i = 0; i < nodes; ++i) of.begin[i + 1] += of.begin[i];
  of.elements.resize(elements.size());
  std::vector<int> next(of.begin.begin(), of.begin.end() - 1);
  for (Eigen::Index e = 0; e < elements.cols(); ++e) {
    for (Eigen::Index a = 0; a < elements.rows(); ++a) {
      of.elements[next[elements(a, e)]++] = static_cast<int>(e);
    }
  }
  return of;
}

// sum += block · node for three rows of `width` entries each, one row after the other.
LACUNA_FOR_EACH_INSTRUCTION_SET
void AddBlockProduct(const double* block, const double* node, int width, double* sum) {
  const double *x = node, *y = node + width, *z = node + 2 * static_cast<int64_t>(width);
  double *a = sum, *b = sum + width, *c = sum + 2 * static_cast<int64_t>(width);
#pragma omp simd
  for (int k = 0; k < width; ++k) {
    a[k] += block[0] * x[k] + block[3] * y[k] + block[6] * z[k];
    b[k] += block[1] * x[k] + block[4] * y[k] + block[7] * z[k];
    c[k] += block[2] * x[k] + block[5] * y[k] + block[8] * z[k];
  }
}

// y = Σ block · x over the blocks of a row. Each column of a block is read together with the entry
// after it, which is ignored; hence values_ has one more entry.
LACUNA_FOR_EACH_INSTRUCTION_SET
void MultiplyRow(const double* block, const int* column, int count, const double* x, double* y) {
  Four sum = {0, 0, 0, 0};
  for (int k = 0; k < count; ++k, block += 9) {
    const double* node = x + 3 * static_cast<int64_t>(column[k]);
    sum += *reinterpret_cast<const UnalignedFour*>(block) * node[0] +
           *reinterpret_cast<const UnalignedFour*>(block + 3) * node[1] +
           *reinterpret_cast<const UnalignedFour*>(block + 6) * node[2];
  }
  for (int a = 0; a < 3; ++a) y[a] = sum[a];
}

}  // namespace

int BlockPattern::Find(int row, int col) const {
  const auto begin = column.begin() + row_begin[row], end = column.begin() + row_begin[row + 1];
  const auto at = std::lower_bound(begin, end, col);
  return at != end && *at == col ? static_cast<int>(at - column.begin()) : -1;
}

BlockPattern MakeBlockPattern(int nodes, const Eigen::MatrixXi& elements) {
  const NodeElements of = ElementsOfNodes(nodes, elements);
  BlockPattern pattern;
  pattern.nodes = nodes;
  pattern.row_begin.assign(1, 0);
  pattern.diagonal.resize(nodes);
  std::vector<int> row;
  for (int i = 0; i < nodes; ++i) {
    row.assign(1, i);
    for (int k = of.begin[i]; k < of.begin[i + 1]; ++k) {
      const auto element = elements.col(of.elements[k]);
      row.insert(row.end(), element.begin(), element.end());
    }
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    const auto self = std::lower_bound(row.begin(), row.end(), i);
    pattern.diagonal[i] = pattern.row_begin[i] + static_cast<int>(self - row.begin());
    pattern.column.insert(pattern.column.end(), row.begin(), row.end());
    pattern.row_begin.push_back(static_cast<int>(pattern.column.size()));
  }
  return pattern;
}

BlockMatrix::BlockMatrix(std::shared_ptr<const BlockPattern> pattern)
    : pattern_(std::move(pattern)),
      values_(9 * static_cast<size_t>(pattern_->BlockCount()) + 1, 0.0) {}

void BlockMatrix::SetZero() { std::fill(values_.begin(), values_.end(), 0.0); }

Eigen::MatrixXd BlockMatrix::operator*(const Eigen::MatrixXd& x) const {
  CHECK_EQ(x.rows(), 3 * pattern_->nodes);
  // Row-major storage, so that each block is applied to all columns at once.
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Rows of_nodes = x;
  Rows product(x.rows(), x.cols());
  const int width = static_cast<int>(x.cols());
  ParallelFor(pattern_->nodes, kRowsPerBlock, [&](int64_t i) {
    product.middleRows<3>(3 * i).setZero();
    for (int k = pattern_->row_begin[i]; k < pattern_->row_begin[i + 1]; ++k)
      AddBlockProduct(&values_[9 * k], of_nodes.row(3 * pattern_->column[k]).data(), width,
                      product.row(3 * i).data());
  });
  return product;
}

void BlockMatrix::Multiply(const Eigen::VectorXd& x, Eigen::VectorXd* y) const {
  CHECK_EQ(x.size(), 3 * pattern_->nodes);
  CHECK_NE(&x, y) << "the product cannot overwrite its argument";
  y->resize(x.size());
  ParallelFor(pattern_->nodes, kRowsPerBlock, [&](int64_t i) {
    const int begin = pattern_->row_begin[i];
    MultiplyRow(&values_[9 * static_cast<size_t>(begin)], &pattern_->column[begin],
                pattern_->row_begin[i + 1] - begin, x.data(), y->data() + 3 * i);
  });
}

}  // namespace lacuna
