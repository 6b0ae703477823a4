#include "geometry/thinned_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace lacuna {
namespace {

using testing::ElementsAre;

// A square of n × n vertices in the plane z = 0, facing +z.
TriMesh Square(int n) {
  TriMesh square;
  square.vertices.resize(3, n * n);
  square.triangles.resize(3, 2 * (n - 1) * (n - 1));
  Eigen::Index t = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      square.vertices.col(i * n + j) << i, j, 0;
      if (i + 1 == n || j + 1 == n) continue;
      const int a = i * n + j;
      square.triangles.col(t++) << a, a + n, a + 1;
      square.triangles.col(t++) << a + n, a + n + 1, a + 1;
    }
  return square;
}

TEST(ThinnedSurface, ASmallSurfaceStaysAsItIs) {
  const TriMesh square = Square(4);
  const ThinnedSurface thinned = ThinSurface(square, 16);
  EXPECT_EQ(thinned.kept.size(), 16u);
  EXPECT_EQ(thinned.triangles, square.triangles);
}

TEST(ThinnedSurface, ALargeOneKeepsItsAreaAndOrientationWithFewerVertices) {
  const TriMesh square = Square(60);
  const ThinnedSurface thinned = ThinSurface(square, 500);
  EXPECT_LE(thinned.kept.size(), 500u);
  EXPECT_GT(thinned.kept.size(), 250u);  // nearly as many as allowed
  TriMesh drawn{square.vertices(Eigen::all, thinned.kept), thinned.triangles};
  // A margin of at most one cell of about 2.7 is lost at each side of 59.
  EXPECT_GT(TriangleAreas(drawn).sum(), 0.85 * 59 * 59);
  EXPECT_GT(TriangleNormals(drawn).row(2).minCoeff(), 0.99);
}

TEST(ThinnedSurface, EvenlySpreadKeepsFirstAndLast) {
  EXPECT_THAT(EvenlySpread(3, 10), ElementsAre(0, 1, 2));
  EXPECT_THAT(EvenlySpread(9, 3), ElementsAre(0, 4, 8));
  EXPECT_THAT(EvenlySpread(5, 1), ElementsAre(4));
  EXPECT_THAT(EvenlySpread(0, 3), ElementsAre());
  const std::vector<int> spread = EvenlySpread(1234, 100);
  EXPECT_EQ(std::set<int>(spread.begin(), spread.end()).size(), 100u);
  EXPECT_EQ(spread.back(), 1233);
}

}  // namespace
}  // namespace lacuna
