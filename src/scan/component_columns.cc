#include "scan/component_columns.h"

#include <algorithm>
#include <iterator>

#include "core/quantity.h"

namespace lacuna {
namespace {

constexpr const char* kAxes[] = {"x", "y", "z"};

}  // namespace

bool NamesComponents(const Config& item) {
  return item.Has("along") || std::any_of(std::begin(kAxes), std::end(kAxes),
                                          [&](const char* axis) { return item.Has(axis); });
}

ComponentColumns ReadComponentColumns(const Config& item) {
  ComponentColumns read;
  for (int axis = 0; axis < 3; ++axis) {
    if (!item.Has(kAxes[axis])) continue;
    read.columns.push_back(item.Text(kAxes[axis]));
    read.labels.emplace_back(kAxes[axis]);
    read.directions.conservativeResize(3, read.directions.cols() + 1);
    read.directions.rightCols<1>() = Eigen::Vector3d::Unit(axis);
  }
  if (!item.Has("along")) {
    if (read.columns.empty())
      item.Fail("file",
                "says nothing about its direction: name the columns of the components `x`, `y`, "
                "`z`, or give `along: [1, 0, 0]` and the column `value`");
    return read;
  }
  if (!read.columns.empty())
    item.Fail("along", "the components x, y, z already have columns: give either these or `along`");
  const Eigen::Vector3d along = item.Vector("along", kDimensionless);
  if (!(along.norm() > 0)) item.Fail("along", "expected a direction other than 0");
  return {{"along"}, along.normalized(), {item.Text("value")}};
}

}  // namespace lacuna
