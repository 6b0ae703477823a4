// Scale, rotation and translation: how a file's coordinates lie in the world.
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

// The metres of one "m", "mm", "cm", "um" or "in".
double LengthOf(const std::string& unit);

// Reads `length_unit`, one of those; required where `default_unit` is empty.
std::string ReadLengthUnit(const Config& config, const std::string& default_unit);

// Reads `scale` (a plain number, multiplied by `length_unit`, m), the rotation as `axis` with
// `angle` or as `matrix` of nine numbers row by row, and `translation`. All are optional. A matrix
// that is not a rotation to 1e-4 is refused; a smaller rounding is taken out.
Similarity ReadSimilarity(const Config& config, double length_unit);

// The same for the mapping `transform`, where there is one.
std::optional<Similarity> ReadTransform(const Config& config, double length_unit);

// The nearest rotation to `matrix`; nothing when it is further than 1e-4 from one or a reflection.
std::optional<Eigen::Matrix3d> RotationUpToRounding(const Eigen::Matrix3d& matrix);

}  // namespace lacuna

#endif  // LACUNA_SCAN_SIMILARITY_H_
