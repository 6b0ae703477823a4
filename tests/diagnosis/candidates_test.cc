#include "diagnosis/candidates.h"

#include <gtest/gtest.h>

#include <cmath>

#include "effects/catalogue.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

std::vector<CandidateEffect> CandidatesOf(const TetMesh& mesh, const std::string& type) {
  const Body body = MakeBody(mesh, 1000);
  const std::vector<std::shared_ptr<const Effect>> effects{
      MakeEffect("neo_hookean", {{"young_modulus", 1e5}, {"poisson_ratio", 0.4}})};
  std::vector<CandidateEffect> chosen;
  for (const CandidateEffect& candidate : MakeCandidates({body, effects, 0.001, 1}))
    if (candidate.type == type) chosen.push_back(candidate);
  return chosen;
}

// An L: a plate without one quarter of it.
TetMesh Angle() {
  TetMesh mesh = BoxMesh({0, 0, 0}, {0.08, 0.06, 0.014}, {8, 6, 2});
  std::vector<int> kept;
  for (Eigen::Index e = 0; e < mesh.tets.cols(); ++e) {
    const Eigen::Vector3d centre = mesh.nodes(Eigen::all, mesh.tets.col(e)).rowwise().mean();
    if (centre.x() < 0.04 || centre.y() < 0.03) kept.push_back(static_cast<int>(e));
  }
  mesh.tets = mesh.tets(Eigen::all, kept).eval();
  std::vector<int> used, number(mesh.nodes.cols(), -1);
  for (int& node : mesh.tets.reshaped()) {
    if (number[node] < 0) {
      number[node] = static_cast<int>(used.size());
      used.push_back(node);
    }
    node = number[node];
  }
  mesh.nodes = mesh.nodes(Eigen::all, used).eval();
  return mesh;
}

TEST(Candidates, HavePlacesAllOverWhatIsNoBar) {
  const std::vector<CandidateEffect> masses = CandidatesOf(Angle(), "attached_mass");
  ASSERT_EQ(masses.size(), 16u);
  for (double x = 0.005; x < 0.08; x += 0.01) {
    for (double y = 0.005; y < (x < 0.04 ? 0.06 : 0.03); y += 0.01) {
      double away = 1;
      int near = 0;
      for (const CandidateEffect& mass : masses) {
        const Eigen::Vector3d& place = mass.position.place;
        EXPECT_TRUE(place.x() < 0.04 || place.y() < 0.03) << place.transpose();
        const double distance = (place - Eigen::Vector3d(x, y, 0.007)).norm();
        away = std::min(away, distance);
        near += distance < mass.position.spacing;
      }
      EXPECT_LT(away, 0.015) << x << " " << y;
      EXPECT_GE(near, 2) << "neighbours of " << x << " " << y;
    }
  }
  EXPECT_EQ(CandidatesOf(Angle(), "stiffness_gradient").size(), 2u);
}

TEST(Candidates, HavePlacesAlongABar) {
  const TetMesh bar = BoxMesh({0, 0, 0}, {0.08, 0.02, 0.02}, {8, 2, 2});
  const std::vector<CandidateEffect> masses = CandidatesOf(bar, "attached_mass");
  ASSERT_EQ(masses.size(), 7u);
  EXPECT_EQ(masses[0].position.spacing, 0);
  EXPECT_EQ(masses[0].variant, "at 5 % of the length");
  EXPECT_EQ(CandidatesOf(bar, "stiffness_gradient").size(), 1u);
}

}  // namespace
}  // namespace lacuna
