// The order in which the elements of a mesh are visited when they add into shared arrays.
//
// Elements are sorted along a space-filling curve and cut into chunks; chunks that share no node
// get the same colour. Colours run one after another, the chunks of a colour at the same time, the
// elements of a chunk one after another. So two threads never touch the same node, an element may
// add straight into nodal vectors and matrix blocks, and each node meets its elements in the same
// order for any number of threads: results are bit-identical.
#ifndef LACUNA_FEM_ELEMENT_SCHEDULE_H_
#define LACUNA_FEM_ELEMENT_SCHEDULE_H_

#include <Eigen/Core>
#include <vector>

#include "core/parallel.h"
#include "fem/block_matrix.h"
#include "geometry/tet_mesh.h"

namespace lacuna {

struct ElementSchedule {
  std::vector<int> order;         // element numbers along the curve
  std::vector<int> chunk_begin;   // chunks + 1, positions in `order`; chunks sorted by colour
  std::vector<int> colour_begin;  // colours + 1, chunk numbers
  // Where block (a, b) of element e lies in the matrix: block[(e·n + a)·n + b], n nodes per
  // element.
  std::vector<int> block;

  int ChunkCount() const { return static_cast<int>(chunk_begin.size()) - 1; }
  int ColourCount() const { return static_cast<int>(colour_begin.size()) - 1; }
};

ElementSchedule MakeElementSchedule(const TetMesh& mesh, const BlockPattern& pattern);

// Calls visit(element) for each element, as described above.
template <typename Visit>
void ForEachElement(const ElementSchedule& schedule, const Visit& visit) {
  for (int colour = 0; colour < schedule.ColourCount(); ++colour) {
    const int first = schedule.colour_begin[colour];
    ParallelFor(schedule.colour_begin[colour + 1] - first, 1, [&](int64_t k) {
      const int chunk = first + static_cast<int>(k);
      for (int i = schedule.chunk_begin[chunk]; i < schedule.chunk_begin[chunk + 1]; ++i) {
        visit(schedule.order[i]);
      }
    });
  }
}

// The sum of value(element) over all elements, independent of the number of threads.
template <typename Value>
double SumOverElements(const ElementSchedule& schedule, const Value& value) {
  std::vector<double> partial(schedule.ChunkCount(), 0.0);
  ParallelFor(schedule.ChunkCount(), 1, [&](int64_t chunk) {
    double sum = 0;
    for (int i = schedule.chunk_begin[chunk]; i < schedule.chunk_begin[chunk + 1]; ++i) {
      sum += value(schedule.order[i]);
    }
    partial[chunk] = sum;
  });
  double total = 0;
  for (const double sum : partial) total += sum;
  return total;
}

}  // namespace lacuna

#endif  // LACUNA_FEM_ELEMENT_SCHEDULE_H_
