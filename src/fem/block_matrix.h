// A sparse matrix of a finite-element body in 3 × 3 blocks, one block per pair of coupled nodes.
//
// The pattern is fixed by the mesh: block (i, j) is present if nodes i and j share an element. Both
// triangles are stored, so that products and accesses by rows are sequential in memory; whether the
// matrix is symmetric depends on the values. Vectors are 3·nodes, node-major.
#ifndef LACUNA_FEM_BLOCK_MATRIX_H_
#define LACUNA_FEM_BLOCK_MATRIX_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace lacuna {

// The positions of the blocks, in compressed rows. Built once per mesh and shared by its matrices.
struct BlockPattern {
  int nodes = 0;
  std::vector<int> row_begin;  // nodes + 1: first block of each block row
  std::vector<int> column;     // block column of each block, ascending within a row
  std::vector<int> diagonal;   // nodes: position of block (i, i)

  int BlockCount() const { return static_cast<int>(column.size()); }
  // The position of block (row, col), or −1 if it is not present.
  int Find(int row, int col) const;
};

// The pattern for `elements`, node numbers of k nodes × m elements. Each node is also coupled with
// itself. CHECKs the node numbers.
BlockPattern MakeBlockPattern(int nodes, const Eigen::MatrixXi& elements);

class BlockMatrix {
 public:
  explicit BlockMatrix(std::shared_ptr<const BlockPattern> pattern);

  const BlockPattern& pattern() const { return *pattern_; }
  std::shared_ptr<const BlockPattern> shared_pattern() const { return pattern_; }

  void SetZero();
  // Block k, a 3 × 3 matrix in column-major storage; the map refers to this matrix.
  Eigen::Map<Eigen::Matrix3d> Block(int k) { return Eigen::Map<Eigen::Matrix3d>(&values_[9 * k]); }
  Eigen::Map<const Eigen::Matrix3d> Block(int k) const {
    return Eigen::Map<const Eigen::Matrix3d>(&values_[9 * k]);
  }
  double* values() { return values_.data(); }
  const double* values() const { return values_.data(); }

  // y = A x, in parallel over rows; x and y must be different vectors of length 3·nodes.
  void Multiply(const Eigen::VectorXd& x, Eigen::VectorXd* y) const;
  // A x for a matrix x (3·nodes × k).
  Eigen::MatrixXd operator*(const Eigen::MatrixXd& x) const;

 private:
  std::shared_ptr<const BlockPattern> pattern_;
  std::vector<double> values_;  // 9 per block, column-major, and one that is not used
};

}  // namespace lacuna

#endif  // LACUNA_FEM_BLOCK_MATRIX_H_
