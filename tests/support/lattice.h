// A lattice of springs with the sparsity of a tetrahedral mesh: a small stand-in for a stiffness
// matrix whose properties are plain to see.
#ifndef LACUNA_TESTS_SUPPORT_LATTICE_H_
#define LACUNA_TESTS_SUPPORT_LATTICE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "fem/block_matrix.h"
#include "fem/held_components.h"

namespace lacuna {

// Holds the nodes whose flag is set along all axes, and leaves the others free.
inline HeldComponents HoldNodes(const std::vector<char>& whole) {
  std::vector<AxisSet> axes(whole.size());
  for (size_t i = 0; i < whole.size(); ++i)
    if (whole[i]) axes[i] = AxisSet::All();
  return HeldComponents(std::move(axes));
}

// A block of n × n × n nodes, each coupled by springs to its neighbours along the lattice's edges
// and diagonals: a small stand-in for a stiffness matrix, with one end held.
struct Lattice {
  int n;
  std::shared_ptr<const BlockPattern> pattern;
  std::vector<char> fixed;

  explicit Lattice(int size) : n(size), fixed(Nodes(), 0) {
    const int path[6][3] = {{1, 3, 7}, {1, 5, 7}, {2, 3, 7}, {2, 6, 7}, {4, 5, 7}, {4, 6, 7}};
    const int cells = n - 1;
    Eigen::MatrixXi tets(4, 6 * cells * cells * cells);
    Eigen::Index e = 0;
    for (int z = 0; z < cells; ++z) {
      for (int y = 0; y < cells; ++y) {
        for (int x = 0; x < cells; ++x) {
          const auto corner = [&](int k) {
            return Node(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2));
          };
          for (const auto& p : path) {
            tets.col(e++) << corner(0), corner(p[0]), corner(p[1]), corner(p[2]);
          }
        }
      }
    }
    pattern = std::make_shared<BlockPattern>(MakeBlockPattern(Nodes(), tets));
    for (int k = 0; k < n * n; ++k) fixed[k] = 1;
  }

  int Nodes() const { return n * n * n; }
  int Node(int x, int y, int z) const { return x + n * (y + n * z); }

  // Springs of random stiffness between 1 and 2, along edges turned by `angle` about z, plus a
  // mass on each node.
  BlockMatrix Stiffness(double angle, double mass) const {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(1, 2);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    BlockMatrix matrix(pattern);
    for (int i = 0; i < Nodes(); ++i) {
      matrix.Block(pattern->diagonal[i]) += mass * Eigen::Matrix3d::Identity();
      for (int k = pattern->row_begin[i]; k < pattern->row_begin[i + 1]; ++k) {
        const int j = pattern->column[k];
        if (j <= i) continue;
        const Eigen::Vector3d edge = turn * (Position(j) - Position(i)).normalized();
        const Eigen::Matrix3d spring =
            uniform(random) * (edge * edge.transpose() + 0.05 * Eigen::Matrix3d::Identity());
        matrix.Block(k) -= spring;
        matrix.Block(pattern->Find(j, i)) -= spring.transpose();
        matrix.Block(pattern->diagonal[i]) += spring;
        matrix.Block(pattern->diagonal[j]) += spring;
      }
    }
    return matrix;
  }

  Eigen::Vector3d Position(int node) const {
    return Eigen::Vector3d(node % n, node / n % n, node / (n * n));
  }
};

// Independent normal values, the same on each call.
inline Eigen::VectorXd RandomVector(Eigen::Index size) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Eigen::VectorXd v(size);
  for (double& value : v) value = normal(random);
  return v;
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_SUPPORT_LATTICE_H_
