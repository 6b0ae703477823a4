// A line chart as SVG, for a browser, a report, or a program for vector graphics.
#ifndef LACUNA_REPORT_LINE_CHART_H_
#define LACUNA_REPORT_LINE_CHART_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace lacuna {

struct ChartLine {
  std::string name;
  Eigen::VectorXd x, y;  // of equal length; NaN leaves a gap
};

struct LineChart {
  std::string title, x_name, y_name;
  std::vector<ChartLine> lines;
};

// Writes the chart atomically. The axes extend from the smallest to the largest finite value.
// Throws InputError when the file cannot be written. CHECKs that x and y have equal length.
void WriteLineChart(const std::filesystem::path& file, const LineChart& chart);

}  // namespace lacuna

#endif  // LACUNA_REPORT_LINE_CHART_H_
