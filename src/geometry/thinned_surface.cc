#include "geometry/thinned_surface.h"

#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace lacuna {
namespace {

using Cell = std::array<int, 3>;

// The vertices of each occupied cell of a grid with this spacing, m.
std::map<Cell, std::vector<int>> CellsOf(const Eigen::Matrix3Xd& vertices, double spacing) {
  const Eigen::Vector3d corner = vertices.rowwise().minCoeff();
  std::map<Cell, std::vector<int>> cells;
  for (Eigen::Index v = 0; v < vertices.cols(); ++v) {
    const Eigen::Vector3d at = (vertices.col(v) - corner) / spacing;
    cells[{static_cast<int>(at[0]), static_cast<int>(at[1]), static_cast<int>(at[2])}].push_back(
        static_cast<int>(v));
  }
  return cells;
}

// The cells of the finest grid that has no more than `most` of them, found by bisection.
std::map<Cell, std::vector<int>> Clusters(const Eigen::Matrix3Xd& vertices, int most) {
  constexpr int kHalvings = 12;
  double coarse = BoundingBoxDiagonal(vertices) + 1e-300, fine = 0;
  std::map<Cell, std::vector<int>> best = CellsOf(vertices, coarse);
  for (int k = 0; k < kHalvings; ++k) {
    const double spacing = fine == 0 ? 0.25 * coarse : 0.5 * (coarse + fine);
    std::map<Cell, std::vector<int>> cells = CellsOf(vertices, spacing);
    if (cells.size() > static_cast<size_t>(most)) {
      fine = spacing;
    } else {
      coarse = spacing;
      best = std::move(cells);
    }
  }
  return best;
}

int NearestToMean(const Eigen::Matrix3Xd& vertices, const std::vector<int>& cluster) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const int v : cluster) mean += vertices.col(v) / static_cast<double>(cluster.size());
  return *std::min_element(cluster.begin(), cluster.end(), [&](int a, int b) {
    return (vertices.col(a) - mean).squaredNorm() < (vertices.col(b) - mean).squaredNorm();
  });
}

}  // namespace

ThinnedSurface ThinSurface(const TriMesh& surface, int most) {
  CHECK_GT(most, 0);
  const int count = static_cast<int>(surface.vertices.cols());
  ThinnedSurface thinned;
  if (count <= most) {
    thinned.kept.resize(static_cast<size_t>(count));
    std::iota(thinned.kept.begin(), thinned.kept.end(), 0);
    thinned.triangles = surface.triangles;
    return thinned;
  }
  std::vector<int> stands_for(static_cast<size_t>(count));
  for (const auto& [cell, cluster] : Clusters(surface.vertices, most)) {
    const int kept = NearestToMean(surface.vertices, cluster);
    thinned.kept.push_back(kept);
    for (const int v : cluster) stands_for[static_cast<size_t>(v)] = kept;
  }
  std::sort(thinned.kept.begin(), thinned.kept.end());
  const auto place_of = [&](int vertex) {
    const int kept = stands_for[static_cast<size_t>(vertex)];
    return static_cast<int>(std::lower_bound(thinned.kept.begin(), thinned.kept.end(), kept) -
                            thinned.kept.begin());
  };
  std::set<Cell> triangles;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    Cell corners{};
    for (int c = 0; c < 3; ++c) corners[static_cast<size_t>(c)] = place_of(surface.triangles(c, t));
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    triangles.insert(corners);
  }
  thinned.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  Eigen::Index t = 0;
  for (const Cell& corners : triangles)
    thinned.triangles.col(t++) << corners[0], corners[1], corners[2];
  return thinned;
}

std::vector<int> EvenlySpread(int count, int most) {
  CHECK_GT(most, 0);
  const int chosen = std::min(count, most);
  std::vector<int> numbers;
  for (int i = 0; i < chosen; ++i)
    numbers.push_back(chosen > 1
                          ? static_cast<int>(static_cast<int64_t>(i) * (count - 1) / (chosen - 1))
                          : count - 1);
  return numbers;
}

}  // namespace lacuna
