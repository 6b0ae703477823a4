#include "report/line_chart.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/atomic_file.h"

namespace lacuna {
namespace {

constexpr double kWidth = 800, kHeight = 480, kLeft = 80, kRight = 140, kTop = 40, kBottom = 50;
constexpr int kTicks = 5;
constexpr std::array kColours{"#1f6fb4", "#d9661f", "#2a9d4b", "#8a56b0", "#b0323a", "#6b6b6b"};

// The range of an axis and its position on the page.
struct Axis {
  double least = std::numeric_limits<double>::infinity();
  double largest = -std::numeric_limits<double>::infinity();
  double from = 0, to = 0;  // pixels

  void Take(const Eigen::VectorXd& values) {
    for (const double value : values) {
      if (!std::isfinite(value)) continue;
      least = std::min(least, value);
      largest = std::max(largest, value);
    }
  }
  void Settle() {
    if (!(least <= largest)) least = largest = 0;
    if (least == largest) largest = least + 1;
  }
  double PlaceOf(double value) const {
    return from + (to - from) * (value - least) / (largest - least);
  }
  double Tick(int i) const { return least + (largest - least) * i / (kTicks - 1); }
};

std::string Escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '<') {
      result += "&lt;";
    } else if (c == '&') {
      result += "&amp;";
    } else {
      result += c;
    }
  }
  return result;
}

std::string Text(double x, double y, const char* anchor, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor,
                     Escaped(text));
}

std::string Path(const ChartLine& line, const Axis& across, const Axis& up, const char* colour) {
  std::string path;
  bool pen_down = false;
  for (Eigen::Index i = 0; i < line.x.size(); ++i) {
    if (!std::isfinite(line.x[i]) || !std::isfinite(line.y[i])) {
      pen_down = false;
      continue;
    }
    path += fmt::format("{}{:.2f} {:.2f} ", pen_down ? 'L' : 'M', across.PlaceOf(line.x[i]),
                        up.PlaceOf(line.y[i]));
    pen_down = true;
  }
  return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"/>\n", path,
                     colour);
}

}  // namespace

void WriteLineChart(const std::filesystem::path& file, const LineChart& chart) {
  Axis across, up;
  for (const ChartLine& line : chart.lines) {
    CHECK_EQ(line.x.size(), line.y.size()) << line.name;
    across.Take(line.x);
    up.Take(line.y);
  }
  across.Settle();
  up.Settle();
  across.from = kLeft;
  across.to = kWidth - kRight;
  up.from = kHeight - kBottom;
  up.to = kTop;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"sans-serif\" "
      "font-size=\"13\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
      kWidth, kHeight);
  svg += Text(kLeft, kTop - 16, "start", chart.title);
  for (int i = 0; i < kTicks; ++i) {
    const double x = across.PlaceOf(across.Tick(i)), y = up.PlaceOf(up.Tick(i));
    svg += fmt::format("<path d=\"M{:.1f} {:.1f} H{:.1f}\" stroke=\"#dddddd\" fill=\"none\"/>\n",
                       kLeft, y, across.to);
    svg += Text(kLeft - 8, y + 4, "end", fmt::format("{:.4g}", up.Tick(i)));
    svg += Text(x, up.from + 18, "middle", fmt::format("{:.4g}", across.Tick(i)));
  }
  svg += Text(0.5 * (across.from + across.to), kHeight - 12, "middle", chart.x_name);
  svg += Text(8, kTop - 16, "start", chart.y_name);
  for (size_t k = 0; k < chart.lines.size(); ++k) {
    const char* colour = kColours[k % kColours.size()];
    svg += Path(chart.lines[k], across, up, colour);
    const double y = kTop + 20 * static_cast<double>(k);
    svg += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"14\" height=\"4\" fill=\"{}\"/>\n",
                       across.to + 14, y - 5, colour);
    svg += Text(across.to + 34, y, "start", chart.lines[k].name);
  }
  WriteFileAtomically(file, svg + "</svg>\n");
}

}  // namespace lacuna
