#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "fem/elimination_order.h"
#include "meshing/tetrahedralize.h"
#include "support/shapes.h"

namespace lacuna {
namespace {

// METIS and TetGen draw from the same random numbers of the process. A diagnosis and a plan mesh in
// one thread while another one sets up a solver.
TEST(RepeatableMeshing, AnEliminationOrderIsTheSameWhileAnotherThreadMeshes) {
  const TriMesh surface = BoxSurface({0.2, 0.03, 0.04}, {14, 2, 3});
  const TetMesh mesh = MeshTetrahedra(surface, {.max_volume = 1e-7}).mesh;
  const BlockPattern pattern = MakeBlockPattern(mesh.NodeCount(), mesh.tets);
  const std::vector<char> fixed(static_cast<size_t>(mesh.NodeCount()), 0);
  const std::vector<int> alone = NestedDissection(pattern, fixed).node;
  std::atomic<bool> is_done = false;
  std::thread mesher([&] {
    while (!is_done) MeshTetrahedra(surface, {.max_volume = 1e-6});
  });
  int others = 0;
  for (int k = 0; k < 100; ++k) others += NestedDissection(pattern, fixed).node != alone;
  is_done = true;
  mesher.join();
  EXPECT_EQ(others, 0);
}

}  // namespace
}  // namespace lacuna
