// Simple closed surfaces whose measures are known.
#ifndef LACUNA_SUPPORT_SHAPES_H_
#define LACUNA_SUPPORT_SHAPES_H_

#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "geometry/tet_mesh.h"
#include "geometry/tri_mesh.h"
#include "support/box_mesh.h"

namespace lacuna {

inline TriMesh MeshOf(const std::vector<Eigen::Vector3d>& vertices,
                      const std::vector<std::array<int, 3>>& triangles) {
  TriMesh mesh{Eigen::Matrix3Xd(3, vertices.size()), Eigen::Matrix3Xi(3, triangles.size())};
  for (size_t v = 0; v < vertices.size(); ++v) mesh.vertices.col(v) = vertices[v];
  for (size_t t = 0; t < triangles.size(); ++t) {
    mesh.triangles.col(t) << triangles[t][0], triangles[t][1], triangles[t][2];
  }
  return mesh;
}

// The vertices and triangles of both surfaces, first those of `a`.
inline TriMesh Together(const TriMesh& a, const TriMesh& b) {
  TriMesh both{Eigen::Matrix3Xd(3, a.vertices.cols() + b.vertices.cols()),
               Eigen::Matrix3Xi(3, a.triangles.cols() + b.triangles.cols())};
  both.vertices << a.vertices, b.vertices;
  both.triangles << a.triangles, (b.triangles.array() + static_cast<int>(a.vertices.cols()));
  return both;
}

// An icosahedron whose triangles are quartered `subdivisions` times, pushed out to the sphere.
inline TriMesh Icosphere(double radius, int subdivisions) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::vector<Eigen::Vector3d> vertices{{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                        {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                        {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  std::vector<std::array<int, 3>> triangles{
      {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int i, int j) {
      const auto [place, is_new] =
          middles.try_emplace(std::minmax({i, j}), static_cast<int>(vertices.size()));
      if (is_new) vertices.push_back(0.5 * (vertices[i] + vertices[j]));
      return place->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : triangles) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    triangles = std::move(finer);
    for (Eigen::Vector3d& v : vertices) v.normalize();
  }
  for (Eigen::Vector3d& v : vertices) v = radius * v.normalized();
  return MeshOf(vertices, triangles);
}

// The surface of a box with one corner at the origin.
inline TriMesh BoxSurface(const Eigen::Vector3d& size, const std::array<int, 3>& cells) {
  return ExtractBoundary(BoxMesh(Eigen::Vector3d::Zero(), size, cells)).surface;
}

// A lobed body of about unit radius with no symmetry.
inline TriMesh OrganicSurface(int subdivisions) {
  TriMesh mesh = Icosphere(1, subdivisions);
  for (auto v : mesh.vertices.colwise()) {
    v *= 1 + 0.15 * std::sin(2 * v.x() + 1) + 0.2 * v.y() * v.z() + 0.1 * std::cos(3 * v.z());
    v.x() *= 1.7;
    v.y() += 0.3 * v.x() * v.x();
  }
  return mesh;
}

// A flat rectangle in z = 0 with normals along z.
inline TriMesh FlatSheet(double width, double height, int columns, int rows) {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i)
      vertices.emplace_back(width * i / columns, height * j / rows, 0);
  }
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const int a = i + (columns + 1) * j, b = a + 1, c = b + columns, d = c + 1;
      triangles.push_back({a, b, d});
      triangles.push_back({a, d, c});
    }
  }
  return MeshOf(vertices, triangles);
}

}  // namespace lacuna

#endif  // LACUNA_SUPPORT_SHAPES_H_
