#include "fem/element_schedule.h"

#include <glog/logging.h>

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace lacuna {
namespace {

// Spreads the lowest 21 bits of x, each followed by two zeros.
uint64_t SpreadBits(uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  x = (x | x << 2) & 0x1249249249249249;
  return x;
}

// Assigns to each chunk the lowest colour that no neighbouring chunk has. Only 64 colours are
// tracked per node; a chunk for which all of them are taken gets a colour of its own.
std::vector<int> ColourChunks(const TetMesh& mesh) {
  constexpr int kSize = ElementSchedule::kElementsPerChunk;
  const int elements = static_cast<int>(mesh.TetCount());
  const int chunks = (elements + kSize - 1) / kSize;
  std::vector<uint64_t> taken_at_node(mesh.NodeCount(), 0);
  std::vector<int> colour(chunks);
  int next_own_colour = 64;
  for (int c = 0; c < chunks; ++c) {
    const auto tets = mesh.tets.middleCols(c * kSize, std::min(kSize, elements - c * kSize));
    uint64_t taken = 0;
    for (const int node : tets.reshaped()) taken |= taken_at_node[node];
    if (taken == ~uint64_t{0}) {
      colour[c] = next_own_colour++;
      continue;
    }
    colour[c] = 0;
    while (taken >> colour[c] & 1) ++colour[c];
    for (const int node : tets.reshaped()) taken_at_node[node] |= uint64_t{1} << colour[c];
  }
  return colour;
}

}  // namespace

std::vector<int> ElementsAlongCurve(const TetMesh& mesh) {
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

ElementSchedule MakeElementSchedule(const TetMesh& mesh, const BlockPattern& pattern) {
  const std::vector<int> colour = ColourChunks(mesh);
  const int chunks = static_cast<int>(colour.size());
  ElementSchedule schedule;
  schedule.elements = static_cast<int>(mesh.TetCount());
  schedule.chunk.resize(chunks);
  std::iota(schedule.chunk.begin(), schedule.chunk.end(), 0);
  std::stable_sort(schedule.chunk.begin(), schedule.chunk.end(),
                   [&](int a, int b) { return colour[a] < colour[b]; });
  for (int k = 0; k < chunks; ++k) {
    if (k == 0 || colour[schedule.chunk[k]] != colour[schedule.chunk[k - 1]]) {
      schedule.colour_begin.push_back(k);
    }
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
