#include "scan/camera_reader.h"

#include <fmt/format.h>

#include "scan/similarity.h"

namespace lacuna {
namespace {

Eigen::Isometry3d ReadPose(const Config& config, const std::string& key, double length_unit) {
  const std::vector<double> numbers = config.Quantities(key, kDimensionless, kAnyValue);
  if (numbers.size() != 16) {
    config.Fail(key,
                fmt::format("got {} numbers; expected a 4 × 4 matrix row by row", numbers.size()));
  }
  using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  const Eigen::Matrix4d matrix = Eigen::Map<const RowMajor>(numbers.data());
  const auto rotation = RotationUpToRounding(matrix.topLeftCorner<3, 3>());
  const Eigen::RowVector4d last(0, 0, 0, 1);
  if (!rotation || matrix.row(3) != last) {
    const bool is_transposed = rotation && matrix.col(3) == last.transpose();
    config.Fail(key, is_transposed
                         ? "has its numbers column by column; write the matrix row by row, "
                           "with the last row 0 0 0 1"
                         : "is not a rigid motion: an orthonormal 3 × 3 block of "
                           "determinant 1, a translation, and the last row 0 0 0 1");
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = *rotation;
  pose.translation() = length_unit * matrix.topRightCorner<3, 1>();
  return pose;
}

}  // namespace

Camera ReadCamera(const Config& config, double length_unit, size_t number) {
  Camera camera;
  camera.name = config.Text("name", fmt::format("camera {}", number + 1));
  const Config intrinsics = config.Child("intrinsics");
  camera.intrinsics = {intrinsics.Number("fx", kPositive), intrinsics.Number("fy", kPositive),
                       intrinsics.Number("cx", kAnyValue), intrinsics.Number("cy", kAnyValue)};
  const bool to_world = config.Has("world_from_camera");
  if (to_world == config.Has("camera_from_world")) {
    config.Fail("", "expected one pose, either world_from_camera or camera_from_world");
  }
  camera.world_from_camera = to_world
                                 ? ReadPose(config, "world_from_camera", length_unit)
                                 : ReadPose(config, "camera_from_world", length_unit).inverse();
  return camera;
}

}  // namespace lacuna
