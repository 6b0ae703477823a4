#include "diagnosis/candidates.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "diagnosis/refit_reach.h"
#include "effects/catalogue.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

std::vector<CandidateEffect> CandidatesOf(const TetMesh& mesh, const std::string& type) {
  const Body body = MakeBody(mesh, 1000);
  const std::vector<std::shared_ptr<const Effect>> effects{
      MakeEffect("neo_hookean", {{"young_modulus", 1e5}, {"poisson_ratio", 0.4}})};
  std::vector<CandidateEffect> chosen;
  for (const CandidateEffect& candidate : MakeCandidates({body, effects, kReferenceBody, 0.001, 1}))
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

std::vector<std::string> VariantsOf(const std::vector<CandidateEffect>& candidates) {
  std::vector<std::string> variants;
  for (const CandidateEffect& candidate : candidates) variants.push_back(candidate.variant);
  return variants;
}

TEST(Candidates, TrySupportsOnEachSideThatIsNotGripped) {
  const TetMesh bar = BoxMesh({0, -0.01, -0.01}, {0.09, 0.01, 0.01}, {9, 2, 2});
  const Body body = MakeBody(bar, 1000);
  const EffectList effects{
      MakeEffect("neo_hookean", {{"young_modulus", 1e5}, {"poisson_ratio", 0.4}})};
  std::vector<char> gripped(body.NodeCount(), 0);
  for (int i = 0; i < body.NodeCount(); ++i) gripped[i] = bar.nodes(0, i) < 0.001;
  std::vector<CandidateEffect> supports, slipping;
  for (const CandidateEffect& candidate :
       MakeCandidates({body, effects, kReferenceBody, 0.001, 1, {}, {}, gripped})) {
    if (candidate.type == "elastic_support") supports.push_back(candidate);
    if (candidate.type == "slipping_support") slipping.push_back(candidate);
  }
  // The girth; the free end; four long sides with three places each.
  ASSERT_EQ(supports.size(), 4u + 1 + 4 * 4);
  EXPECT_THAT(
      VariantsOf(supports),
      testing::IsSupersetOf({"of the whole surface", "at 50 % of the length", "on the +x side",
                             "on the −z side", "on the −z side at x = 50 mm"}));
  EXPECT_THAT(VariantsOf(supports), testing::Not(testing::Contains("on the −x side")));
  EXPECT_EQ(slipping.size(), 2u * (4 + 5));

  const auto at = [](const CandidateEffect& candidate, const std::string& name) {
    return candidate.effect->Parameters()[ParameterIndex(candidate.effect->Card(), name)];
  };
  for (const CandidateEffect& support : supports) {
    const auto range = [&](const std::string& name) { return support.known.at(name); };
    if (support.variant == "on the −z side") {
      EXPECT_EQ(at(support, "side_z"), -1);
      for (const char* name : {"point_x", "point_y", "point_z", "radius"})
        EXPECT_TRUE(range(name).IsHeld()) << name;
    }
    if (support.variant == "at 50 % of the length") {
      EXPECT_EQ(at(support, "side_z"), 0);
      EXPECT_FALSE(range("point_x").IsHeld());
      EXPECT_TRUE(range("point_y").IsHeld());
    }
    if (support.variant != "on the −z side at x = 50 mm") continue;
    // A third of the free length, from 10 to 90 mm, lies within a radius of the place.
    EXPECT_NEAR(at(support, "point_x"), 0.05, 1e-12);
    EXPECT_NEAR(at(support, "point_z"), -0.01, 1e-12);
    EXPECT_NEAR(at(support, "radius"), 0.08 / 6, 1e-12);
    EXPECT_NEAR(range("point_x").min, 0.01, 1e-12);
    EXPECT_NEAR(range("point_x").max, 0.09, 1e-12);
    EXPECT_TRUE(range("point_y").IsHeld()) << "across a strip";
    EXPECT_TRUE(range("point_z").IsHeld());
    EXPECT_EQ(range("point_z").min, at(support, "point_z"));
    EXPECT_NEAR(range("radius").min, 0.08 / 24, 1e-12);
  }
}

// A refit moves a place, an angle or a time, but not a setting such as the side of the body.
TEST(Candidates, ReachTheVariantsThatDifferInWhatARefitMoves) {
  const TetMesh bar = BoxMesh({0, -0.01, -0.01}, {0.09, 0.01, 0.01}, {9, 2, 2});
  const auto share = [&](const std::string& type, const std::string& variant) {
    const std::vector<CandidateEffect> all = CandidatesOf(bar, type);
    for (const CandidateEffect& candidate : all)
      if (variant.empty() || candidate.variant == variant) return ReachableShare(candidate, all);
    ADD_FAILURE() << type << " has no variant " << variant;
    return 0.0;
  };
  EXPECT_EQ(share("drag", ""), 1);
  EXPECT_EQ(share("attached_mass", "at 50 % of the length"), 1);
  EXPECT_EQ(share("fibre_stiffness", ""), 1);
  EXPECT_EQ(share("active_contraction", ""), 1.0 / 13);
  // The girth; six sides, four of them long ones with three places each.
  const double variants = 4 + 6 + 4 * 3;
  EXPECT_EQ(share("elastic_support", "of the whole surface"), 1 / variants);
  EXPECT_EQ(share("elastic_support", "at 50 % of the length"), 3 / variants);
  EXPECT_EQ(share("elastic_support", "on the −z side"), 1 / variants);
  EXPECT_EQ(share("elastic_support", "on the −z side at x = 45 mm"), 3 / variants);
}

TEST(Candidates, DoNotIncludeWhatTheModelExcludes) {
  const TetMesh bar = BoxMesh({0, 0, 0}, {0.08, 0.02, 0.02}, {8, 2, 2});
  EXPECT_EQ(CandidatesOf(bar, "swelling").size(), 1u);
  const Body body = MakeBody(bar, 1000);
  const EffectList effects{
      MakeEffect("neo_hookean", {{"young_modulus", 1e5}, {"poisson_ratio", 0.4}}),
      MakeEffect(
          Config::Parse("{type: swelling_field, strain: 1 %, field: \"Z/0.02\"}", "a.yaml"))};
  for (const CandidateEffect& candidate : MakeCandidates({body, effects, kReferenceBody, 0.001, 1}))
    EXPECT_NE(candidate.type, "swelling");
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
