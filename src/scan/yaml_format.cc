#include "scan/yaml_format.h"

#include <fmt/format.h>

namespace lacuna {

std::string FormatVector(const Eigen::Vector3d& vector, const char* unit) {
  return fmt::format("[{0} {3}, {1} {3}, {2} {3}]", vector.x(), vector.y(), vector.z(), unit);
}

}  // namespace lacuna
