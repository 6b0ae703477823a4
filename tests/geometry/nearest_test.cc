#include "geometry/nearest.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/parallel.h"
#include "support/shapes.h"

namespace lacuna {
namespace {

using Eigen::Vector3d;

Eigen::Matrix3Xd RandomPoints(int count, double scale, uint64_t seed) {
  std::mt19937_64 generator(seed);
  Eigen::Matrix3Xd points(3, count);
  for (double& x : points.reshaped()) {
    x = scale * (2 * static_cast<double>(generator() >> 11) * 0x1p-53 - 1);
  }
  return points;
}

// An independent computation of the distance: a dense search over the barycentric triangle that is
// refined around the best point.
double DistanceBySearch(const Vector3d& a, const Vector3d& b, const Vector3d& c,
                        const Vector3d& p) {
  double best = std::numeric_limits<double>::infinity();
  double s0 = 0, t0 = 0, reach = 1;
  for (int round = 0; round < 40; ++round, reach *= 0.6) {
    double s_best = s0, t_best = t0;
    for (int i = -6; i <= 6; ++i) {
      for (int j = -6; j <= 6; ++j) {
        const double s = std::clamp(s0 + reach * i / 6, 0.0, 1.0);
        const double t = std::clamp(t0 + reach * j / 6, 0.0, 1.0 - s);
        const double distance = (a + s * (b - a) + t * (c - a) - p).norm();
        if (distance < best) best = distance, s_best = s, t_best = t;
      }
    }
    s0 = s_best, t0 = t_best;
  }
  return best;
}

TEST(SurfaceSearch, AgreesWithAnExhaustiveSearch) {
  const TriMesh body = OrganicSurface(2);
  const Eigen::Matrix3Xd queries = RandomPoints(40, 2.5, 1);
  const SurfaceHits hits = SurfaceSearch(body).Nearest(queries);
  for (Eigen::Index i = 0; i < queries.cols(); ++i) {
    double best = std::numeric_limits<double>::infinity();
    for (const auto t : body.triangles.colwise()) {
      best = std::min(best, DistanceBySearch(body.vertices.col(t(0)), body.vertices.col(t(1)),
                                             body.vertices.col(t(2)), queries.col(i)));
    }
    // The search narrows down to 0.6^40 = 1e-9 of a triangle; near the foot the distance changes
    // with the square of that, or with it where the foot is pinned to a border.
    EXPECT_NEAR(hits.distance(i), best, 1e-8);
    EXPECT_LE(hits.distance(i), best + 1e-14);
  }
}

TEST(SurfaceSearch, ResultsBelongTogether) {
  const TriMesh body = OrganicSurface(4);
  const Eigen::Matrix3Xd queries = RandomPoints(2000, 2.5, 2);
  const SurfaceHits hits = SurfaceSearch(body).Nearest(queries);
  EXPECT_GE(hits.barycentric.minCoeff(), 0);
  EXPECT_NEAR((hits.barycentric.colwise().sum().array() - 1).abs().maxCoeff(), 0, 1e-14);
  for (Eigen::Index i = 0; i < queries.cols(); ++i) {
    const Eigen::Matrix3d corners = body.vertices(Eigen::all, body.triangles.col(hits.triangle(i)));
    EXPECT_LT((corners * hits.barycentric.col(i) - hits.point.col(i)).norm(), 1e-14);
    EXPECT_NEAR((queries.col(i) - hits.point.col(i)).norm(), hits.distance(i), 1e-14);
  }
}

TEST(SurfaceSearch, FindsPointsOnTheSurface) {
  const TriMesh body = OrganicSurface(4);
  const SurfaceSamples samples = SampleSurface(body, 5000, 3);
  const SurfaceHits hits = SurfaceSearch(body).Nearest(EvaluateSamples(body, samples).points);
  // A few rounding errors of coordinates of size 2.
  EXPECT_LT(hits.distance.maxCoeff(), 2e-15);
}

TEST(SurfaceSearch, DistanceToASphereIsKnown) {
  const TriMesh sphere = Icosphere(1, 5);
  const Eigen::Matrix3Xd queries = RandomPoints(1000, 3, 4);
  const SurfaceHits hits = SurfaceSearch(sphere).Nearest(queries);
  for (Eigen::Index i = 0; i < queries.cols(); ++i) {
    // The facets lie up to (edge 0.04)²/6 inside the sphere.
    EXPECT_NEAR(hits.distance(i), std::abs(queries.col(i).norm() - 1), 3e-4);
  }
}

TEST(SurfaceSearch, TakesTheFirstOfEquallyNearTriangles) {
  TriMesh twice = Icosphere(1, 2);
  const Eigen::Index count = twice.triangles.cols();
  twice.triangles.conservativeResize(3, 2 * count);
  twice.triangles.rightCols(count) = twice.triangles.leftCols(count);
  const SurfaceHits hits = SurfaceSearch(twice).Nearest(RandomPoints(500, 2, 5));
  EXPECT_LT(hits.triangle.maxCoeff(), count);
}

TEST(SurfaceSearch, CopesWithTrianglesWithoutArea) {
  const TriMesh mesh =
      MeshOf({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 5, 5}}, {{0, 1, 2}, {0, 2, 1}, {3, 3, 3}});
  Eigen::Matrix3Xd queries(3, 3);
  queries << 0.5, -3, 5, 2, 0, 5, 0, 0, 6;
  const SurfaceHits hits = SurfaceSearch(mesh).Nearest(queries);
  EXPECT_EQ(hits.distance, Vector3d(2, 3, 1));
  EXPECT_TRUE(hits.barycentric.allFinite());
}

TEST(SurfaceSearch, MarksQueriesThatAreNotFinite) {
  Eigen::Matrix3Xd queries = Eigen::Matrix3Xd::Zero(3, 2);
  queries(1, 0) = std::numeric_limits<double>::quiet_NaN();
  queries(2, 1) = std::numeric_limits<double>::infinity();
  const SurfaceHits hits = SurfaceSearch(Icosphere(1, 1)).Nearest(queries);
  EXPECT_EQ(hits.triangle(0), -1);
  EXPECT_EQ(hits.triangle(1), -1);
  EXPECT_TRUE(std::isinf(hits.distance(0)));
}

TEST(SurfaceSearch, DoesNotDependOnTheNumberOfThreads) {
  const SurfaceSearch search(OrganicSurface(4));
  const Eigen::Matrix3Xd queries = RandomPoints(5000, 2, 6);
  SetThreadCount(1);
  const SurfaceHits one = search.Nearest(queries);
  SetThreadCount(2);
  const SurfaceHits two = search.Nearest(queries);
  EXPECT_EQ(one.point, two.point);
  EXPECT_EQ(one.triangle, two.triangle);
  EXPECT_EQ(one.distance, two.distance);
}

TEST(PointSearch, AgreesWithAnExhaustiveSearch) {
  const Eigen::Matrix3Xd points = RandomPoints(1500, 1, 8), queries = RandomPoints(200, 1.2, 9);
  constexpr int kNeighbours = 7;
  const PointHits hits = PointSearch(points).Nearest(queries, kNeighbours);
  for (Eigen::Index i = 0; i < queries.cols(); ++i) {
    Eigen::VectorXd distance = (points.colwise() - queries.col(i)).colwise().norm();
    for (int k = 0; k < kNeighbours; ++k) {
      Eigen::Index nearest;
      EXPECT_NEAR(hits.distance(k, i), distance.minCoeff(&nearest), 1e-14);
      EXPECT_EQ(hits.index(k, i), nearest);
      distance(nearest) = std::numeric_limits<double>::infinity();
    }
  }
}

TEST(PointSearch, ReturnsAsManyNeighboursAsThereArePoints) {
  const PointHits hits = PointSearch(RandomPoints(3, 1, 10)).Nearest(RandomPoints(5, 1, 11), 3);
  EXPECT_EQ(hits.index.rows(), 3);
  EXPECT_TRUE((hits.index.colwise().sum().array() == 3).all());  // 0 + 1 + 2
}

}  // namespace
}  // namespace lacuna
