#include "report/line_chart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/temporary_folder.h"

namespace lacuna {
namespace {

TEST(LineChart, DrawsEveryFinitePointAndInterruptsTheLineAtAGap) {
  const TemporaryFolder folder;
  Eigen::VectorXd x(4), y(4);
  x << 1, 2, 3, 4;
  y << 5, std::nan(""), 7, 6;
  WriteLineChart(folder / "chart.svg", {"a < b", "x", "y", {{"first", x, y}}});
  const std::string svg = FileContent(folder / "chart.svg");
  // x runs from 80 to 660 pixels, y from 430 (the least value) to 40 (the largest).
  EXPECT_NE(svg.find("d=\"M80.00 430.00 M466.67 40.00 L660.00 235.00 \""), std::string::npos)
      << svg;
  EXPECT_NE(svg.find("a &lt; b"), std::string::npos);
}

TEST(LineChart, AcceptsValuesThatAreAllEqualOrAbsent) {
  const TemporaryFolder folder;
  WriteLineChart(folder / "flat.svg",
                 {"flat", "x", "y", {{"one", Eigen::VectorXd::Ones(1), Eigen::VectorXd::Ones(1)}}});
  WriteLineChart(folder / "empty.svg", {"empty", "x", "y", {}});
  for (const char* name : {"flat.svg", "empty.svg"}) {
    const std::string svg = FileContent(folder / name);
    EXPECT_EQ(svg.find("nan"), std::string::npos) << name;
    EXPECT_NE(svg.find("</svg>"), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace lacuna
