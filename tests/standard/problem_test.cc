#include "standard/problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "standard/verification_table.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;

// Problem LE10, whose published stress is −5.38 MPa, with further keys of the wanted quantity.
Problem ReadLe10(const std::filesystem::path& folder, const std::string& more) {
  std::string text = FileContent(LACUNA_SOURCE_DIR "/tests/standard/problems/le10.yaml");
  const std::string value = "value: -5.38 MPa}";
  text.replace(text.find(value), value.size(), "value: -5.38 MPa" + more + "}");
  std::ofstream(folder / "le10.yaml") << text;
  return ReadProblem(folder / "le10.yaml");
}

TEST(StandardProblemFile, ShowsNumbersInTheUnitBesideThem) {
  const TemporaryFolder folder;
  const auto row = [&](const std::string& more) {
    const Problem problem = ReadLe10(folder.Path(), more);
    EXPECT_DOUBLE_EQ(problem.wanted.at(0).value, -5.38e6) << "in SI units";
    ProblemSolution solution;
    solution.values = {-5.4e6};
    return VerificationTable({{problem, {RefinementStudy{2, {solution}}}}});
  };
  EXPECT_THAT(row(", shown_in: MPa"), HasSubstr("| stress_yy | 2 | -5.38 MPa | -5.4 MPa |"));
  EXPECT_THAT(row(""), HasSubstr("| stress_yy | 2 | -5.38e+06 Pa | -5.4e+06 Pa |"));
}

TEST(StandardProblemFile, RefusesAUnitOfAnotherQuantity) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { ReadLe10(folder.Path(), ", shown_in: mm"); },
              ::testing::ThrowsMessage<InputError>(HasSubstr("shown_in")));
}

}  // namespace
}  // namespace lacuna
