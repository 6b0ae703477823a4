#include "scan/frame_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <tuple>
#include <vector>

#include "core/error.h"
#include "geometry/finite_columns.h"
#include "scan/components.h"

namespace lacuna {
namespace {

constexpr double kFarthest = 1e9;  // m
constexpr double kForgotten = std::numeric_limits<double>::quiet_NaN();

bool IsUsable(const PointCloud& raw, Eigen::Index row) {
  return (raw.points.col(row).array().abs() < kFarthest).all();
}

}  // namespace

Eigen::Index ForgetRepeatedPoints(bool tracked, Eigen::Matrix3Xd* points) {
  constexpr size_t kPlaceholder = 16;
  std::vector<Eigen::Index> order = FiniteColumns(*points);
  const auto key = [points](Eigen::Index i) {
    const auto point = points->col(i);
    return std::tuple(point.x(), point.y(), point.z());
  };
  std::sort(order.begin(), order.end(), [&key](Eigen::Index a, Eigen::Index b) {
    const auto left = key(a), right = key(b);
    return left < right || (left == right && a < b);
  });
  std::vector<Eigen::Index> forgotten;
  for (size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && key(order[end]) == key(order[begin])) ++end;
    const size_t count = end - begin;
    if (count < 2) continue;
    const bool is_placeholder =
        points->col(order[begin]).isZero(0) ||
        count >= std::max<size_t>(kPlaceholder, static_cast<size_t>(points->cols()) / 100);
    if (tracked && !is_placeholder) continue;
    forgotten.insert(forgotten.end(), order.begin() + begin + (is_placeholder ? 0 : 1),
                     order.begin() + end);
  }
  for (const Eigen::Index i : forgotten) points->col(i).setConstant(kForgotten);
  return static_cast<Eigen::Index>(forgotten.size());
}

void ForgetOtherObjects(const FileFrames& source, const Eigen::Matrix3Xi& triangles,
                        Eigen::Matrix3Xd* points, Frame* frame) {
  if (source.crop) {
    for (Eigen::Index i = 0; i < points->cols(); ++i) {
      auto point = points->col(i);
      if (!point.allFinite() || Contains(*source.crop, point)) continue;
      point.setConstant(kForgotten);
      ++frame->cropped_count;
    }
  }
  if (!source.keep_largest) return;
  const Eigen::VectorXi component =
      triangles.cols() > 0 ? ComponentsOfSurface({*points, triangles}) : ComponentsOfCloud(*points);
  for (Eigen::Index i = 0; i < points->cols(); ++i) {
    if (component[i] == 0 || !points->col(i).allFinite()) continue;
    points->col(i).setConstant(kForgotten);
    ++frame->separate_count;
  }
}

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
  for (auto normal : frame->cloud.normals.colwise())
    if (!normal.allFinite()) normal.setZero();

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
    std::string message = fmt::format("none of its {} points {}", frame.row_count, condition);
    if (frame.repeated_count > 0)
      message += fmt::format(" and measured: {} repeat exactly", frame.repeated_count);
    if (frame.cropped_count > 0)
      message += fmt::format("; {} lie outside the crop", frame.cropped_count);
    throw InputError(message);
  }
  if (frame.cloud.Size() < fewest) {
    throw InputError(fmt::format("holds {} usable point{}; expected at least {}",
                                 frame.cloud.Size(), frame.cloud.Size() == 1 ? "" : "s", fewest));
  }
}

}  // namespace lacuna
