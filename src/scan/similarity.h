// Similarity transforms, which take the coordinates in a file to the world frame.
#ifndef LACUNA_SCAN_SIMILARITY_H_
#define LACUNA_SCAN_SIMILARITY_H_

#include <Eigen/Core>
#include <optional>
#include <string>

#include "core/config.h"

namespace lacuna {

// x_world = rotation · (scale · x_file) + translation.
struct Similarity {
  double scale = 1;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // m

  Eigen::Matrix3Xd operator*(const Eigen::Matrix3Xd& points) const {
    return (rotation * (scale * points)).colwise() + translation;
  }
};

// The length of one `unit` in metres, for "m", "mm", "cm", "um" and "in"; 0 for any other unit.
double LengthOf(const std::string& unit);

// Reads `length_unit`, which must be one of those. It is required when `default_unit` is empty.
std::string ReadLengthUnit(const Config& config, const std::string& default_unit);

// Reads `scale` (a plain number, multiplied by `length_unit`, m), the rotation as `axis` with
// `angle` or as `matrix` of nine numbers row by row, and `translation`. All are optional. A matrix
// is replaced by the nearest rotation, which removes its rounding. Throws InputError (file, line,
// column and field) when it is further than 1e-4 from a rotation or when the rotation is given
// twice.
Similarity ReadSimilarity(const Config& config, double length_unit);

// Reads the mapping `transform` as above. Without one the result only scales by `length_unit`, m.
Similarity ReadWorldFromFile(const Config& config, double length_unit);

// The rotation nearest to `matrix`, or nothing when `matrix` is a reflection or further than 1e-4
// (Frobenius norm) from every rotation.
std::optional<Eigen::Matrix3d> RotationUpToRounding(const Eigen::Matrix3d& matrix);

}  // namespace lacuna

#endif  // LACUNA_SCAN_SIMILARITY_H_
