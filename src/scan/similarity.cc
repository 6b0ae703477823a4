#include "scan/similarity.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>

namespace lacuna {
namespace {

const std::vector<std::pair<std::string, double>> kLengthUnits = {
    {"m", 1}, {"mm", 1e-3}, {"cm", 1e-2}, {"um", 1e-6}, {"in", 0.0254}};

}  // namespace

double LengthOf(const std::string& unit) {
  for (const auto& [name, length] : kLengthUnits) {
    if (name == unit) return length;
  }
  return 0;
}

std::string ReadLengthUnit(const Config& config, const std::string& default_unit) {
  const double length = default_unit.empty()
                            ? config.Choice("length_unit", kLengthUnits)
                            : config.Choice("length_unit", kLengthUnits, default_unit);
  for (const auto& [name, value] : kLengthUnits) {
    if (value == length) return name;
  }
  return "m";
}

std::optional<Eigen::Matrix3d> RotationUpToRounding(const Eigen::Matrix3d& matrix) {
  // Accepts matrices written with five or more digits.
  constexpr double kRounding = 1e-4;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose();
  if (!((rotation - matrix).norm() <= kRounding) || rotation.determinant() < 0) return std::nullopt;
  return rotation;
}

Similarity ReadSimilarity(const Config& config, double length_unit) {
  Similarity similarity;
  similarity.scale = length_unit * config.Number("scale", kPositive, 1.0);
  similarity.translation = config.Vector("translation", kLength, Eigen::Vector3d::Zero());
  if (config.Has("matrix")) {
    const std::vector<double> numbers = config.Quantities("matrix", kDimensionless, kAnyValue);
    if (numbers.size() != 9) {
      config.Fail("matrix",
                  fmt::format("got {} numbers; expected nine, row by row", numbers.size()));
    }
    using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    const auto rotation = RotationUpToRounding(Eigen::Map<const RowMajor>(numbers.data()));
    if (!rotation) config.Fail("matrix", "is not a rotation (orthonormal rows, determinant 1)");
    similarity.rotation = *rotation;
    if (config.Has("axis") || config.Has("angle")) {
      config.Fail("axis", "the rotation is given twice: as a matrix and as axis and angle");
    }
  } else if (config.Has("axis") || config.Has("angle")) {
    const Eigen::Vector3d axis = config.Vector("axis", kDimensionless);
    if (axis.norm() == 0) config.Fail("axis", "has no direction");
    const double angle = config.Quantity("angle", kAngle, kAnyValue);
    similarity.rotation = Eigen::AngleAxisd(angle, axis.normalized()).matrix();
  }
  return similarity;
}

Similarity ReadWorldFromFile(const Config& config, double length_unit) {
  const std::optional<Config> transform = config.OptionalChild("transform");
  if (transform) return ReadSimilarity(*transform, length_unit);
  Similarity scaling;
  scaling.scale = length_unit;
  return scaling;
}

}  // namespace lacuna
