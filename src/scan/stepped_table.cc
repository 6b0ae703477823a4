#include "scan/stepped_table.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <utility>

#include "core/error.h"

namespace lacuna {

SteppedTable DivideIntoSteps(DelimitedTable table, const std::string& step,
                             const std::string& time) {
  const Eigen::Index step_column = RequireColumn(table, step);
  std::map<double, std::vector<Eigen::Index>> rows;
  const auto fail = [&](Eigen::Index row, const std::string& message) {
    throw InputError({table.file.string(), table.line[static_cast<size_t>(row)], 1}, message);
  };
  for (Eigen::Index row = 0; row < table.values.rows(); ++row) {
    const double value = table.values(row, step_column);
    if (!std::isfinite(value)) fail(row, fmt::format("\"{}\" is not finite", step));
    rows[value].push_back(row);
  }
  SteppedTable steps;
  for (auto& [value, of_step] : rows) steps.rows.push_back(std::move(of_step));
  if (!time.empty()) {
    const Eigen::Index time_column = RequireColumn(table, time);
    for (const std::vector<Eigen::Index>& of_step : steps.rows) {
      const double first = table.values(of_step.front(), time_column);
      for (const Eigen::Index row : of_step) {
        const double own = table.values(row, time_column);
        if (!std::isfinite(own)) fail(row, fmt::format("\"{}\" is not finite", time));
        if (own != first)
          fail(row, fmt::format("\"{}\" is {} where line {}, of the same step, has {}", time, own,
                                table.line[static_cast<size_t>(of_step.front())], first));
      }
      steps.times.push_back(first);
    }
  }
  steps.table = std::move(table);
  return steps;
}

DelimitedTable TableOfStep(const SteppedTable& steps, size_t step) {
  DelimitedTable table;
  table.file = steps.table.file;
  table.header = steps.table.header;
  table.units = steps.table.units;
  table.commented_header = steps.table.commented_header;
  const std::vector<Eigen::Index>& rows = steps.rows.at(step);
  table.values = steps.table.values(rows, Eigen::all);
  for (const Eigen::Index row : rows)
    table.line.push_back(steps.table.line[static_cast<size_t>(row)]);
  return table;
}

}  // namespace lacuna
