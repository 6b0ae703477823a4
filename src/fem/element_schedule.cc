#include "fem/element_schedule.h"

#include <glog/logging.h>

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace lacuna {
namespace {

constexpr int kElementsPerChunk = 128;

// The bits of x, each followed by two zeros.
uint64_t SpreadBits(uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  x = (x | x << 2) & 0x1249249249249249;
  return x;
}

std::vector<int> MortonOrder(const TetMesh& mesh) {
  const int elements = static_cast<int>(mesh.TetCount());
  const Eigen::Vector3d low = mesh.nodes.rowwise().minCoeff();
  const double extent = (mesh.nodes.rowwise().maxCoeff() - low).maxCoeff();
  const double scale = extent > 0 ? (1 << 20) / extent : 0;
  std::vector<uint64_t> code(elements);
  for (int e = 0; e < elements; ++e) {
    Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
    for (int a = 0; a < 4; ++a) centroid += 0.25 * mesh.nodes.col(mesh.tets(a, e));
    const Eigen::Vector3d cell = scale * (centroid - low);
    code[e] = SpreadBits(static_cast<uint64_t>(cell.x())) |
              SpreadBits(static_cast<uint64_t>(cell.y())) << 1 |
              SpreadBits(static_cast<uint64_t>(cell.z())) << 2;
  }
  std::vector<int> order(elements);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return code[a] != code[b] ? code[a] < code[b] : a < b; });
  return order;
}

// The lowest colour that no neighbouring chunk has. A node remembers 64 colours; a chunk that finds
// all of them taken gets a colour of its own.
std::vector<int> ColourChunks(const TetMesh& mesh, const std::vector<int>& order) {
  const int elements = static_cast<int>(order.size());
  const int chunks = (elements + kElementsPerChunk - 1) / kElementsPerChunk;
  std::vector<uint64_t> taken_at_node(mesh.NodeCount(), 0);
  std::vector<int> colour(chunks);
  int next_own_colour = 64;
  for (int c = 0; c < chunks; ++c) {
    const int begin = c * kElementsPerChunk;
    const int end = std::min(elements, begin + kElementsPerChunk);
    uint64_t taken = 0;
    for (int i = begin; i < end; ++i) {
      for (const int node : mesh.tets.col(order[i])) taken |= taken_at_node[node];
    }
    if (taken == ~uint64_t{0}) {
      colour[c] = next_own_colour++;
      continue;
    }
    colour[c] = 0;
    while (taken >> colour[c] & 1) ++colour[c];
    const uint64_t bit = uint64_t{1} << colour[c];
    for (int i = begin; i < end; ++i) {
      for (const int node : mesh.tets.col(order[i])) taken_at_node[node] |= bit;
    }
  }
  return colour;
}

}  // namespace

ElementSchedule MakeElementSchedule(const TetMesh& mesh, const BlockPattern& pattern) {
  const std::vector<int> curve = MortonOrder(mesh);
  const std::vector<int> colour = ColourChunks(mesh, curve);
  const int chunks = static_cast<int>(colour.size());
  std::vector<int> by_colour(chunks);
  std::iota(by_colour.begin(), by_colour.end(), 0);
  std::stable_sort(by_colour.begin(), by_colour.end(),
                   [&](int a, int b) { return colour[a] < colour[b]; });

  ElementSchedule schedule;
  schedule.order.reserve(curve.size());
  schedule.chunk_begin.push_back(0);
  for (int k = 0; k < chunks; ++k) {
    const int chunk = by_colour[k];
    if (k == 0 || colour[chunk] != colour[by_colour[k - 1]]) schedule.colour_begin.push_back(k);
    const auto begin = curve.begin() + chunk * kElementsPerChunk;
    const auto left = curve.end() - begin;
    schedule.order.insert(schedule.order.end(), begin,
                          begin + std::min<ptrdiff_t>(left, kElementsPerChunk));
    schedule.chunk_begin.push_back(static_cast<int>(schedule.order.size()));
  }
  schedule.colour_begin.push_back(chunks);

  const int n = static_cast<int>(mesh.tets.rows());
  schedule.block.resize(mesh.TetCount() * n * n);
  ParallelFor(mesh.TetCount(), 1024, [&](int64_t e) {
    for (int a = 0; a < n; ++a) {
      for (int b = 0; b < n; ++b) {
        const int position = pattern.Find(mesh.tets(a, e), mesh.tets(b, e));
        CHECK_GE(position, 0);
        schedule.block[(e * n + a) * n + b] = position;
      }
    }
  });
  return schedule;
}

}  // namespace lacuna
