// The order in which the elements of a mesh are visited when they add to shared arrays.
//
// Elements are sorted along a space-filling curve and divided into chunks of consecutive elements.
// Chunks of the same colour share no node. Colours are processed one after another, the chunks of a
// colour in parallel, and the elements of a chunk one after another. Hence no two threads access
// the same node at the same time, elements may add directly to nodal vectors and matrix blocks, and
// each node receives its contributions in the same order for any number of threads, which makes
// results identical bit by bit.
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
  int elements = 0;               // number of elements
  std::vector<int> chunk;         // numbers of the chunks, sorted by colour
  std::vector<int> colour_begin;  // colours + 1: first position in `chunk`
  // Position in the block matrix of block (a, b) of element e, at block[(e·n + a)·n + b] with n
  // nodes per element.
  std::vector<int> block;

  static constexpr int kElementsPerChunk = 128;
  static constexpr int kElementsPerBatch = 16;
  int ChunkCount() const { return static_cast<int>(chunk.size()); }
  int ColourCount() const { return static_cast<int>(colour_begin.size()) - 1; }
  int ChunkBegin(int c) const { return c * kElementsPerChunk; }
  int ChunkEnd(int c) const { return std::min(elements, (c + 1) * kElementsPerChunk); }
};

// The numbers of the elements, sorted along the Morton curve through their centroids. Elements that
// are close in space become close in memory, which makes assembly twice as fast as in the order of
// a mesh generator.
std::vector<int> ElementsAlongCurve(const TetMesh& mesh);

// The schedule for the elements in the order of `mesh`. The pattern must be that of the same mesh
// (CHECK).
ElementSchedule MakeElementSchedule(const TetMesh& mesh, const BlockPattern& pattern);

// Calls visit(begin, end) for batches of at most kElementsPerBatch consecutive elements, in the
// order described above, until all elements have been visited. Calls run on several threads.
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

// Calls visit(element) for each element in the order described above, on several threads.
template <typename Visit>
void ForEachElement(const ElementSchedule& schedule, const Visit& visit) {
  ForEachBatch(schedule, [&](int begin, int end) {
    for (int e = begin; e < end; ++e) visit(e);
  });
}

// The sum of value(element) over all elements. Its rounding does not depend on the number of
// threads.
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
