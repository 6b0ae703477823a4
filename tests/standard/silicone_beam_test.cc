// Which material law describes the silicone cantilever of problems/silicone_beam.yaml. The law that
// its authors used in COMSOL was not published.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "effects/catalogue.h"
#include "standard/solution.h"

namespace lacuna {
namespace {

// The deflection hardly depends on the law, but under the largest load the tip moves forward by
// 2.00 mm in the reference and, on a mesh of 24 × 8 × 8 cells, by 1.94 mm with the neo-Hookean,
// 1.78 mm with the corotational and 1.53 mm with the St. Venant–Kirchhoff law.
TEST(SiliconeBeam, MovesForwardAsANeoHookeanBodyDoes) {
  Problem problem = ReadProblem(LACUNA_SOURCE_DIR "/tests/standard/problems/silicone_beam.yaml");
  if (!problem.missing_data.empty()) GTEST_SKIP() << "skipped, data absent";
  const Wanted& forward = problem.wanted.back();
  ASSERT_EQ(forward.name, "displacement_x");
  const auto error = [&](const std::string& law) {
    problem.effects.front() = FindEntry(law)->make(problem.effects.front()->Parameters());
    const ProblemSolution solution = Solve(problem, problem.meshes[1], 2);
    EXPECT_TRUE(solution.IsUsable()) << law << ": " << solution.message;
    return std::abs(solution.values.back() - forward.value);
  };
  const double neo_hookean = error("neo_hookean");
  for (const char* law : {"corotational", "st_venant_kirchhoff"})
    EXPECT_GT(error(law), 2 * neo_hookean) << law;
}

}  // namespace
}  // namespace lacuna
