// Formats numbers as entries of recording.yaml. Every number is written with as many digits as it
// takes to read back the same double.
#ifndef LACUNA_SCAN_YAML_FORMAT_H_
#define LACUNA_SCAN_YAML_FORMAT_H_

#include <Eigen/Core>
#include <string>

namespace lacuna {

// Three quantities of one unit as Config::Vector reads them, e.g. "[0 m, 0.1 m, 0 m]".
std::string FormatVector(const Eigen::Vector3d& vector, const char* unit);

}  // namespace lacuna

#endif  // LACUNA_SCAN_YAML_FORMAT_H_
