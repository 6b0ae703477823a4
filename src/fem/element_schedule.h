// The order in which the elements of a mesh are visited when they add into shared arrays.
//
// Elements, sorted along a space-filling curve, are cut into chunks of consecutive ones; chunks
// that share no node get the same colour. Colours run one after another, the chunks of a colour at
// the same time, the elements of a chunk one after another. So two threads never touch the same
// node, an element may add straight into nodal vectors and matrix blocks, and each node meets its
// elements in the same order for any number of threads: results are bit-identical.
#ifndef LACUNA_FEM_ELEMENT_SCHEDULE_H_
#define LACUNA_FEM_ELEMENT_SCHEDULE_H_

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/parallel.h"
#include "fem/block_matrix.h"
#include "geometry/tet_mesh.h"

namespace lacuna {

struct ElementSchedule {
  int elements = 0;
  std::vector<int> chunk;         // chunk numbers, sorted by colour
  std::vector<int> colour_begin;  // colours + 1, positions in `chunk`
  // Where block (a, b) of element e lies in the matrix: block[(e·n + a)·n + b], n nodes per
  // element.
  std::vector<int> block;

  static constexpr int kElementsPerChunk = 128;
  static constexpr int kElementsPerBatch = 16;
  int ChunkCount() const { return static_cast<int>(chunk.size()); }
  int ColourCount() const { return static_cast<int>(colour_begin.size()) - 1; }
  int ChunkBegin(int c) const { return c * kElementsPerChunk; }
  int ChunkEnd(int c) const { return std::min(elements, (c + 1) * kElementsPerChunk); }
};

// The element numbers sorted along the Morton curve of their centroids. Neighbours in space become
// neighbours in memory: assembly is twice as fast as in the order that a mesh generator leaves.
std::vector<int> ElementsAlongCurve(const TetMesh& mesh);

// For elements in the order of `mesh`.
ElementSchedule MakeElementSchedule(const TetMesh& mesh, const BlockPattern& pattern);

// Calls visit(begin, end) for batches of consecutive elements that together are all, as described
// above.
template <typename Visit>
void ForEachBatch(const ElementSchedule& schedule, const Visit& visit) {
  for (int colour = 0; colour < schedule.ColourCount(); ++colour) {
    const int first = schedule.colour_begin[colour];
    ParallelFor(schedule.colour_begin[colour + 1] - first, 1, [&](int64_t k) {
      const int chunk = schedule.chunk[first + k];
      const int end = schedule.ChunkEnd(chunk);
      for (int e = schedule.ChunkBegin(chunk); e < end; e += ElementSchedule::kElementsPerBatch) {
        visit(e, std::min(end, e + ElementSchedule::kElementsPerBatch));
      }
    });
  }
}

// Calls visit(element) for each element, as described above.
template <typename Visit>
void ForEachElement(const ElementSchedule& schedule, const Visit& visit) {
  ForEachBatch(schedule, [&](int begin, int end) {
    for (int e = begin; e < end; ++e) visit(e);
  });
}

// The sum of value(element) over all elements, independent of the number of threads.
template <typename Value>
double SumOverElements(const ElementSchedule& schedule, const Value& value) {
  std::vector<double> partial(schedule.ChunkCount(), 0.0);
  ParallelFor(schedule.ChunkCount(), 1, [&](int64_t chunk) {
    const int begin = schedule.ChunkBegin(static_cast<int>(chunk));
    const int end = schedule.ChunkEnd(static_cast<int>(chunk));
    double sum = 0;
    for (int e = begin; e < end; ++e) sum += value(e);
    partial[chunk] = sum;
  });
  double total = 0;
  for (const double sum : partial) total += sum;
  return total;
}

}  // namespace lacuna

#endif  // LACUNA_FEM_ELEMENT_SCHEDULE_H_
