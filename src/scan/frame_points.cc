#include "scan/frame_points.h"

#include <fmt/format.h>

#include <vector>

#include "core/error.h"

namespace lacuna {
namespace {

constexpr double kFarthest = 1e9;  // m

bool IsUsable(const PointCloud& raw, Eigen::Index row) {
  const bool has_normal = !raw.HasNormals() || raw.normals.col(row).allFinite();
  return has_normal && (raw.points.col(row).array().abs() < kFarthest).all();
}

}  // namespace

void KeepUsablePoints(const PointCloud& raw, const Eigen::Matrix3Xi& triangles, Frame* frame) {
  std::vector<int> kept;
  std::vector<int> new_row(raw.Size(), -1);
  for (int i = 0; i < raw.Size(); ++i) {
    if (!IsUsable(raw, i)) continue;
    new_row[i] = static_cast<int>(kept.size());
    kept.push_back(i);
  }
  frame->row_count = raw.Size();
  frame->dropped_count = raw.Size() - static_cast<Eigen::Index>(kept.size());
  frame->source_row = Eigen::Map<const Eigen::VectorXi>(kept.data(), kept.size());
  frame->cloud.points = raw.points(Eigen::all, kept);
  frame->cloud.normals.resize(3, 0);
  if (raw.HasNormals()) frame->cloud.normals = raw.normals(Eigen::all, kept);

  std::vector<Eigen::Vector3i> whole;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3i corners = triangles.col(t);
    if (corners.maxCoeff() >= raw.Size()) {
      throw InputError(fmt::format("triangle {} has the corner {}; the frame has {} rows", t,
                                   corners.maxCoeff(), raw.Size()));
    }
    const Eigen::Vector3i renumbered(new_row[corners[0]], new_row[corners[1]], new_row[corners[2]]);
    if (renumbered.minCoeff() >= 0) whole.push_back(renumbered);
  }
  frame->triangles.resize(3, whole.size());
  for (size_t t = 0; t < whole.size(); ++t) frame->triangles.col(t) = whole[t];
}

Eigen::Matrix3Xd UnitNormals(const Eigen::Matrix3Xd& normals, const Eigen::Matrix3d& rotation) {
  const Eigen::RowVectorXd lengths = normals.colwise().norm();
  if (normals.cols() == 0 || !(lengths.minCoeff() > 0)) return Eigen::Matrix3Xd(3, 0);
  return rotation * (normals.array().rowwise() / lengths.array()).matrix();
}

void RequirePoints(const Frame& frame, Eigen::Index fewest, const std::string& condition) {
  if (frame.row_count == 0) throw InputError("holds no point");
  if (frame.cloud.Size() == 0) {
    throw InputError(fmt::format("none of its {} points {}", frame.row_count, condition));
  }
  if (frame.cloud.Size() < fewest) {
    throw InputError(fmt::format("holds {} usable point{}; expected at least {}",
                                 frame.cloud.Size(), frame.cloud.Size() == 1 ? "" : "s", fewest));
  }
}

}  // namespace lacuna
