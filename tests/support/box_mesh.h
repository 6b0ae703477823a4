// A structured tetrahedral mesh of a box, for tests.
#ifndef LACUNA_SUPPORT_BOX_MESH_H_
#define LACUNA_SUPPORT_BOX_MESH_H_

#include <Eigen/Core>
#include <array>
#include <functional>
#include <random>
#include <vector>

#include "geometry/tet_mesh.h"

namespace lacuna {

// cells[0] × cells[1] × cells[2] cells between `low` and `high`, each cut into six tetrahedra
// around the same diagonal (Kuhn 1960), so that neighbours conform.
inline TetMesh BoxMesh(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                       const std::array<int, 3>& cells, int order = 1) {
  const auto number = [&cells](int i, int j, int k) {
    return (k * (cells[1] + 1) + j) * (cells[0] + 1) + i;
  };
  TetMesh mesh;
  mesh.nodes.resize(3, number(cells[0], cells[1], cells[2]) + 1);
  for (int k = 0; k <= cells[2]; ++k) {
    for (int j = 0; j <= cells[1]; ++j) {
      for (int i = 0; i <= cells[0]; ++i) {
        const Eigen::Array3d t(1.0 * i / cells[0], 1.0 * j / cells[1], 1.0 * k / cells[2]);
        mesh.nodes.col(number(i, j, k)) = (low.array() * (1 - t) + high.array() * t).matrix();
      }
    }
  }
  // Each tetrahedron walks from corner 000 to 111 along the axes in one of six orders.
  constexpr int kWalks[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  mesh.tets.resize(4, 6 * cells[0] * cells[1] * cells[2]);
  int e = 0;
  for (int k = 0; k < cells[2]; ++k) {
    for (int j = 0; j < cells[1]; ++j) {
      for (int i = 0; i < cells[0]; ++i) {
        for (int walk = 0; walk < 6; ++walk) {
          std::array<int, 3> at{i, j, k};
          Eigen::Vector4i tet;
          tet[0] = number(i, j, k);
          for (int step = 0; step < 3; ++step) {
            ++at[kWalks[walk][step]];
            tet[step + 1] = number(at[0], at[1], at[2]);
          }
          if (walk >= 3) std::swap(tet[1], tet[2]);  // odd walks are left-handed
          mesh.tets.col(e++) = tet;
        }
      }
    }
  }
  return order == 1 ? mesh : ToQuadratic(mesh);
}

// Moves interior corner nodes by up to `fraction` of `spacing` in each direction, so that no
// element is like another. For linear meshes only.
inline TetMesh Jittered(TetMesh mesh, double spacing, double fraction, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-fraction * spacing, fraction * spacing);
  const Eigen::Vector3d low = mesh.nodes.rowwise().minCoeff();
  const Eigen::Vector3d high = mesh.nodes.rowwise().maxCoeff();
  for (Eigen::Index i = 0; i < mesh.NodeCount(); ++i) {
    auto node = mesh.nodes.col(i);
    for (int k = 0; k < 3; ++k) {
      const double move = shift(random);
      if (node[k] > low[k] && node[k] < high[k]) node[k] += move;
    }
  }
  return mesh;
}

// The nodes for which `where` holds.
inline Eigen::VectorXi NodesWhere(const TetMesh& mesh,
                                  const std::function<bool(const Eigen::Vector3d&)>& where) {
  std::vector<int> nodes;
  for (Eigen::Index i = 0; i < mesh.NodeCount(); ++i) {
    if (where(mesh.nodes.col(i))) nodes.push_back(static_cast<int>(i));
  }
  return Eigen::Map<Eigen::VectorXi>(nodes.data(), static_cast<Eigen::Index>(nodes.size()));
}

}  // namespace lacuna

#endif  // LACUNA_SUPPORT_BOX_MESH_H_
