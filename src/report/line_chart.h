// A chart of lines over one axis, as SVG: for a browser, a report, or a vector program.
#ifndef LACUNA_REPORT_LINE_CHART_H_
#define LACUNA_REPORT_LINE_CHART_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace lacuna {

struct ChartLine {
  std::string name;
  Eigen::VectorXd x, y;  // of equal length; a NaN leaves a gap
};

struct LineChart {
  std::string title, x_name, y_name;
  std::vector<ChartLine> lines;
};

// Axes from the least to the largest finite value. Written atomically; throws InputError when it
// cannot be. Lines of unequal x and y are a mistake of the program (CHECK).
void WriteLineChart(const std::filesystem::path& file, const LineChart& chart);

}  // namespace lacuna

#endif  // LACUNA_REPORT_LINE_CHART_H_
