// The half-edges of a triangulated surface, in an order that brings those of an edge together.
#ifndef LACUNA_GEOMETRY_HALF_EDGES_H_
#define LACUNA_GEOMETRY_HALF_EDGES_H_

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace lacuna {

// A triangle's edge from corner k to corner k + 1, as the pair of its vertices.
struct HalfEdge {
  int low, high;         // vertices
  int triangle, corner;  // corner: k
  bool forward;          // whether it runs from the lower to the higher vertex index
  bool IsOfSameEdge(const HalfEdge& other) const { return low == other.low && high == other.high; }
};

// The half-edges of all triangles (3 × m, vertex indices), by vertices, then triangle, then corner.
std::vector<HalfEdge> SortedHalfEdges(const Eigen::Matrix3Xi& triangles);

// Calls use(edge) for each edge, in ascending order, with the span of its half-edges among
// `sorted`: one of them at a boundary, two inside a manifold surface.
template <typename Use>
void ForEachEdge(const std::vector<HalfEdge>& sorted, const Use& use) {
  for (size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
    while (end < sorted.size() && sorted[end].IsOfSameEdge(sorted[begin])) ++end;
    use(std::span<const HalfEdge>(sorted).subspan(begin, end - begin));
  }
}

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_HALF_EDGES_H_
