// The symmetric sparse matrix of a finite-element body, in 3 × 3 blocks.
//
// The pattern is fixed by the mesh: block (i, j) is present when nodes i and j share an element.
// All full rows are stored (not only a triangle), so that products and row-wise gathers are
// sequential in memory; symmetry is a property of the values.
#ifndef LACUNA_FEM_BLOCK_MATRIX_H_
#define LACUNA_FEM_BLOCK_MATRIX_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace lacuna {

// Which blocks are present, and where the contribution of each element goes. Built once per mesh.
struct BlockPattern {
  int nodes = 0;
  std::vector<int> row_begin;  // nodes + 1
  std::vector<int> column;     // block columns, ascending within a row
  std::vector<int> diagonal;   // position of block (i, i)

  int BlockCount() const { return static_cast<int>(column.size()); }
  // Position of block (row, col), or −1.
  int Find(int row, int col) const;
};

// `elements`: k × m node numbers. Pairs of nodes that share an element are coupled, and each node
// with itself.
BlockPattern MakeBlockPattern(int nodes, const Eigen::MatrixXi& elements);

class BlockMatrix {
 public:
  explicit BlockMatrix(std::shared_ptr<const BlockPattern> pattern);

  const BlockPattern& pattern() const { return *pattern_; }
  std::shared_ptr<const BlockPattern> shared_pattern() const { return pattern_; }

  void SetZero();
  // Block k as a 3 × 3 matrix (column-major).
  Eigen::Map<Eigen::Matrix3d> Block(int k) { return Eigen::Map<Eigen::Matrix3d>(&values_[9 * k]); }
  Eigen::Map<const Eigen::Matrix3d> Block(int k) const {
    return Eigen::Map<const Eigen::Matrix3d>(&values_[9 * k]);
  }
  double* values() { return values_.data(); }
  const double* values() const { return values_.data(); }

  // y = A x, threaded over rows; x and y of length 3·nodes, node-major.
  void Multiply(const Eigen::VectorXd& x, Eigen::VectorXd* y) const;
  // The same for each column of x.
  Eigen::MatrixXd operator*(const Eigen::MatrixXd& x) const;

 private:
  std::shared_ptr<const BlockPattern> pattern_;
  std::vector<double> values_;  // 9 per block, column-major
};

}  // namespace lacuna

#endif  // LACUNA_FEM_BLOCK_MATRIX_H_
