#include "geometry/cut_open.h"

#include <algorithm>
#include <array>
#include <set>
#include <vector>

namespace lacuna {
namespace {

using FaceKey = std::array<int, 3>;

FaceKey KeyOf(const Eigen::Vector3i& triangle) {
  FaceKey key{triangle[0], triangle[1], triangle[2]};
  std::sort(key.begin(), key.end());
  return key;
}

Eigen::Matrix3Xi AsColumns(const std::vector<Eigen::Vector3i>& triangles) {
  Eigen::Matrix3Xi columns(3, triangles.size());
  for (size_t k = 0; k < triangles.size(); ++k)
    columns.col(static_cast<Eigen::Index>(k)) = triangles[k];
  return columns;
}

}  // namespace

CutMesh CutOpen(const TetMesh& mesh, const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  const TetMesh whole{mesh.nodes, mesh.tets.topRows(4)};
  std::vector<Eigen::Index> left;
  for (Eigen::Index e = 0; e < whole.TetCount(); ++e) {
    const Eigen::Vector3d centroid = whole.nodes(Eigen::all, whole.tets.col(e)).rowwise().mean();
    if (normal.dot(centroid - point) <= 0) left.push_back(e);
  }
  CutMesh cut{{mesh.nodes, {}}, {mesh.nodes, {}}};
  if (left.empty()) return cut;
  std::set<FaceKey> before;
  const Eigen::MatrixXi whole_faces = ExtractBoundary(whole).faces;
  for (const auto& face : whole_faces.colwise()) before.insert(KeyOf(face));
  std::vector<Eigen::Vector3i> skin, inner;
  const TetMesh half{whole.nodes, whole.tets(Eigen::all, left)};
  const Eigen::MatrixXi half_faces = ExtractBoundary(half).faces;
  for (const auto& face : half_faces.colwise())
    (before.contains(KeyOf(face)) ? skin : inner).emplace_back(face);
  cut.skin.triangles = AsColumns(skin);
  cut.inner.triangles = AsColumns(inner);
  return cut;
}

}  // namespace lacuna
