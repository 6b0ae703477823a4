// The standard problems on the meshes of their quick set.
#include <gtest/gtest.h>

#include <filesystem>
#include <vector>

#include "standard/solution.h"

namespace lacuna {
namespace {

std::vector<std::filesystem::path> ProblemFiles() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry :
       std::filesystem::directory_iterator(LACUNA_SOURCE_DIR "/tests/standard/problems"))
    files.push_back(entry.path());
  return files;
}

class StandardProblem : public testing::TestWithParam<std::filesystem::path> {};

// The tolerances are those of the problem's file. Refinement must not make the error larger, unless
// it is small: there errors of opposite sign may happen to cancel on the coarser mesh, and
// published values have an error of their own.
TEST_P(StandardProblem, HasThePublishedValue) {
  constexpr double kSmall = 0.05;
  const Problem problem = ReadProblem(GetParam());
  if (!problem.missing_data.empty())
    GTEST_SKIP() << "skipped, data absent: " << problem.missing_data.string()
                 << "; LACUNA_DATA names their folder";
  for (size_t k = 0; k < problem.orders.size(); ++k) {
    const RefinementStudy study = Refine(problem, problem.orders[k], problem.quick);
    const size_t last = study.solutions.size() - 1;
    for (size_t wanted = 0; wanted < problem.wanted.size(); ++wanted) {
      SCOPED_TRACE(problem.name + ": " + problem.wanted[wanted].name + ", elements of order " +
                   std::to_string(study.order));
      ASSERT_TRUE(study.solutions[last].IsUsable()) << study.solutions[last].message;
      const double error = study.Error(problem, last, wanted);
      EXPECT_LE(error, problem.tolerances[k]) << study.solutions[last].values[wanted]
                                              << " in place of " << problem.wanted[wanted].value;
      if (last > 0 && error > kSmall) {
        EXPECT_LE(error, study.Error(problem, last - 1, wanted));
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Problems, StandardProblem, testing::ValuesIn(ProblemFiles()),
                         [](const auto& file) { return file.param.stem().string(); });

}  // namespace
}  // namespace lacuna
