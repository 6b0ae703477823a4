#include "fem/body.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <functional>
#include <numbers>
#include <set>

#include "core/error.h"
#include "fem/inverted_element.h"
#include "geometry/shape_functions.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

TetMesh JitteredBox(int order) {
  const TetMesh mesh =
      Jittered(BoxMesh({-0.02, 0.01, 0}, {0.1, 0.05, 0.03}, {9, 5, 4}), 0.01, 0.2, 4);
  return order == 1 ? mesh : ToQuadratic(mesh);
}

constexpr double kVolume = 0.12 * 0.04 * 0.03;

TEST(ShapeFunctions, AreOneAtTheirNodeAndZeroAtTheOthers) {
  Eigen::Matrix4Xd nodes(4, 10);
  nodes << Eigen::Matrix4d::Identity(), Eigen::Matrix<double, 4, 6>{{0.5, 0, 0.5, 0.5, 0, 0},
                                                                    {0.5, 0.5, 0, 0, 0.5, 0},
                                                                    {0, 0.5, 0.5, 0, 0, 0.5},
                                                                    {0, 0, 0, 0.5, 0.5, 0.5}};
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(ShapeValues(2, nodes.col(k)), Eigen::VectorXd::Unit(10, k));
    if (k < 4) {
      EXPECT_EQ(ShapeValues(1, nodes.col(k)), Eigen::VectorXd::Unit(4, k));
    }
  }
}

TEST(ShapeFunctions, HaveTheDerivativesOfTheirValues) {
  const Eigen::Vector4d at(0.1, 0.2, 0.3, 0.4);
  const double h = 1e-3;  // any step is exact for a quadratic function
  for (const int order : {1, 2}) {
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector4d step = h * Eigen::Vector4d::Unit(k);
      const Eigen::VectorXd difference =
          (ShapeValues(order, at + step) - ShapeValues(order, at - step)) / (2 * h);
      EXPECT_LT((ShapeDerivatives(order, at).col(k) - difference).norm(), 1e-12);
    }
  }
}

TEST(Quadrature, IsExactToDegreeTwoOnQuadraticElements) {
  // ∫ ξ₀² = 1/10, ∫ ξ₀ξ₁ = 1/20 of the volume.
  const TetQuadrature rule = ElementQuadrature(2);
  double squares = 0, products = 0;
  for (int p = 0; p < 4; ++p) {
    squares += rule.weights[p] * rule.points(0, p) * rule.points(0, p);
    products += rule.weights[p] * rule.points(0, p) * rule.points(1, p);
  }
  EXPECT_NEAR(squares, 0.1, 1e-15);
  EXPECT_NEAR(products, 0.05, 1e-15);
}

TEST(Body, HasTheMassOfItsVolume) {
  for (const int order : {1, 2}) {
    const Body body = MakeBody(JitteredBox(order), 1070);
    EXPECT_NEAR(body.weight.sum(), kVolume, 1e-14 * kVolume * body.PointCount());
    EXPECT_NEAR(body.node_mass.sum(), 1070 * kVolume, 1e-12);
    EXPECT_GT(body.node_mass.minCoeff(), 0);
  }
}

TEST(Body, DifferentiatesPolynomialsOfItsOrderExactly) {
  for (const int order : {1, 2}) {
    const Body body = MakeBody(JitteredBox(order), 1);
    const auto field = [order](const Eigen::Vector3d& x) {
      return order == 1 ? 2 * x[0] - x[1] + 3 * x[2] : x[0] * x[1] - 2 * x[2] * x[2] + x[0];
    };
    const auto gradient = [order](const Eigen::Vector3d& x) {
      return order == 1 ? Eigen::Vector3d(2, -1, 3) : Eigen::Vector3d(x[1] + 1, x[0], -4 * x[2]);
    };
    for (int e = 0; e < body.ElementCount(); ++e) {
      const Eigen::VectorXi nodes = body.mesh.tets.col(e);
      for (int p = 0; p < body.points_per_element; ++p) {
        const int q = e * body.points_per_element + p;
        Eigen::Vector3d found = Eigen::Vector3d::Zero();
        for (int a = 0; a < nodes.size(); ++a) {
          found += field(body.mesh.nodes.col(nodes[a])) *
                   body.shape_gradient.block<1, 3>(a, 3 * q).transpose();
        }
        ASSERT_LT((found - gradient(body.point.col(q))).norm(), 1e-12);
      }
    }
  }
}

TEST(ElementSchedule, VisitsEachElementOnceAndSharesNoNodeWithinAColour) {
  const Body body = MakeBody(JitteredBox(1), 1);
  const ElementSchedule& schedule = *body.schedule;
  EXPECT_GT(schedule.ChunkCount(), 4);
  std::vector<int> visits(body.ElementCount(), 0);
  ForEachElement(schedule, [&](int e) { ++visits[e]; });
  EXPECT_THAT(visits, testing::Each(1));
  EXPECT_EQ(SumOverElements(schedule, [](int e) { return e; }),
            0.5 * body.ElementCount() * (body.ElementCount() - 1));
  for (int colour = 0; colour < schedule.ColourCount(); ++colour) {
    std::set<int> nodes_of_others;
    for (int k = schedule.colour_begin[colour]; k < schedule.colour_begin[colour + 1]; ++k) {
      std::set<int> nodes;
      for (int e = schedule.ChunkBegin(schedule.chunk[k]); e < schedule.ChunkEnd(schedule.chunk[k]);
           ++e) {
        for (const int node : body.mesh.tets.col(e)) nodes.insert(node);
      }
      for (const int node : nodes) EXPECT_TRUE(nodes_of_others.insert(node).second);
    }
  }
}

TEST(Body, KeepsTheElementNumbersOfTheGivenMesh) {
  const TetMesh mesh = JitteredBox(2);
  const Body body = MakeBody(mesh, 1);
  EXPECT_EQ(body.mesh.nodes, mesh.nodes);
  EXPECT_NE(body.mesh.tets, mesh.tets) << "the elements must have been sorted";
  EXPECT_THAT(std::set<int>(body.given_element.begin(), body.given_element.end()),
              testing::SizeIs(body.ElementCount()));
  for (int e = 0; e < body.ElementCount(); ++e) {
    EXPECT_EQ(body.mesh.tets.col(e), mesh.tets.col(body.given_element[e]));
  }
}

TEST(ElementSchedule, SupportsANodeInMoreChunksThanThereAreColours) {
  // 12 000 thin elements around one edge, whose two nodes belong to about 94 chunks.
  constexpr int kSlivers = 12000;
  TetMesh fan;
  fan.nodes.resize(3, kSlivers + 2);
  fan.tets.resize(4, kSlivers);
  fan.nodes.col(kSlivers) << 0, 0, 0;
  fan.nodes.col(kSlivers + 1) << 0, 0, 1;
  for (int k = 0; k < kSlivers; ++k) {
    const double angle = 2 * std::numbers::pi * k / kSlivers;
    fan.nodes.col(k) << std::cos(angle), std::sin(angle), 0.5;
    fan.tets.col(k) << kSlivers, k, (k + 1) % kSlivers, kSlivers + 1;
  }
  const BlockPattern pattern = MakeBlockPattern(kSlivers + 2, fan.tets);
  const ElementSchedule schedule = MakeElementSchedule(fan, pattern);
  EXPECT_EQ(schedule.ColourCount(), schedule.ChunkCount());
}

std::string ErrorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Body, RejectsInvalidMeshes) {
  using testing::HasSubstr;
  const TetMesh good = BoxMesh({0, 0, 0}, {1, 1, 1}, {1, 1, 1});
  EXPECT_THAT(ErrorOf([&] { MakeBody(good, 0); }), HasSubstr("density"));
  EXPECT_THAT(ErrorOf([&] { MakeBody(TetMesh{}, 1); }), HasSubstr("no element"));
  TetMesh flipped = good;
  std::swap(flipped.tets(0, 3), flipped.tets(1, 3));
  EXPECT_THAT(ErrorOf([&] { MakeBody(flipped, 1); }), HasSubstr("tetrahedron 3 "));
  TetMesh flat = good;
  flat.nodes.row(2).setZero();
  EXPECT_THAT(ErrorOf([&] { MakeBody(flat, 1); }), HasSubstr("volume"));
  TetMesh stray = good;
  stray.tets(2, 1) = 8;
  EXPECT_THAT(ErrorOf([&] { MakeBody(stray, 1); }), HasSubstr("refers to node 8"));
  TetMesh lonely = good;
  lonely.nodes.conservativeResize(3, 9);
  lonely.nodes.col(8) << 2, 2, 2;
  EXPECT_THAT(ErrorOf([&] { MakeBody(lonely, 1); }), HasSubstr("node 8 belongs to no"));
  TetMesh missing = good;
  missing.nodes(1, 2) = std::nan("");
  EXPECT_THAT(ErrorOf([&] { MakeBody(missing, 1); }), HasSubstr("not finite"));
}

TEST(InvertedElement, IsFoundAmongTheElementsOfADisplacedNode) {
  const Body body = MakeBody(JitteredBox(1), 1);
  Eigen::VectorXd position = body.mesh.nodes.reshaped();
  EXPECT_EQ(FindInvertedElement(body, position), -1);
  // Moving one node far away inverts some of its elements and no others.
  const int node = 100;
  position.segment<3>(3 * node) += Eigen::Vector3d(0.5, 0.3, 0.2);
  const int inverted = FindInvertedElement(body, position);
  ASSERT_GE(inverted, 0);
  EXPECT_THAT(JitteredBox(1).tets.col(inverted), testing::Contains(node));
}

}  // namespace
}  // namespace lacuna
