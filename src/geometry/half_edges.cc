#include "geometry/half_edges.h"

#include <algorithm>
#include <tuple>

namespace lacuna {

std::vector<HalfEdge> SortedHalfEdges(const Eigen::Matrix3Xi& triangles) {
  std::vector<HalfEdge> edges;
  edges.reserve(static_cast<size_t>(triangles.size()));
  for (int t = 0; t < triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int from = triangles(k, t), to = triangles((k + 1) % 3, t);
      edges.push_back({std::min(from, to), std::max(from, to), t, k, from < to});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::tie(a.low, a.high, a.triangle, a.corner) <
           std::tie(b.low, b.high, b.triangle, b.corner);
  });
  return edges;
}

}  // namespace lacuna
