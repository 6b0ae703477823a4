// The components of a measured vector, such as a force, and the columns of a file that hold them.
#ifndef LACUNA_SCAN_COMPONENT_COLUMNS_H_
#define LACUNA_SCAN_COMPONENT_COLUMNS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/config.h"

namespace lacuna {

struct ComponentColumns {
  std::vector<std::string> labels;  // c: "x", "y", "z", or "along"
  Eigen::Matrix3Xd directions;  // 3 × c, unit; the columns hold directionsᵀ v of the vector v
  std::vector<std::string> columns;  // c: names, or numbers from 1
};

// Whether an item says which components its file has: with `x`, `y`, `z` or `along`.
bool NamesComponents(const Config& item);

// Reads the keys `x`, `y`, `z`, each the column of that component, of which at least one must be
// there; or `along`, a direction, and `value`, the column of the component along it. Throws
// InputError (file, line, column and field).
ComponentColumns ReadComponentColumns(const Config& item);

}  // namespace lacuna

#endif  // LACUNA_SCAN_COMPONENT_COLUMNS_H_
