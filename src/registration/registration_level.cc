#include "registration/registration_level.h"

#include <algorithm>
#include <cmath>

#include "registration/block_tree.h"
#include "registration/surface_normals.h"

namespace lacuna {
namespace {

Eigen::Matrix3Xd Reordered(const Eigen::Matrix3Xd& points, const std::vector<int>& order) {
  Eigen::Matrix3Xd sorted(3, points.cols());
  for (size_t i = 0; i < order.size(); ++i) sorted.col(i) = points.col(order[i]);
  return sorted;
}

}  // namespace

NormalisedClouds Normalise(const PointCloud& source, const PointCloud& target,
                           const GaussianKernels& kernels) {
  NormalisedClouds clouds;
  clouds.centre = source.points.rowwise().mean();
  clouds.scale = std::sqrt((source.points.colwise() - clouds.centre).squaredNorm() /
                           static_cast<double>(source.Size()));
  if (!(clouds.scale > 0.0)) return clouds;
  clouds.source = (source.points.colwise() - clouds.centre) / clouds.scale;
  clouds.target = (target.points.colwise() - clouds.centre) / clouds.scale;
  clouds.source_order = SpatialOrder(clouds.source.cast<float>());
  clouds.target_order = SpatialOrder(clouds.target.cast<float>());
  clouds.source = Reordered(clouds.source, clouds.source_order);
  clouds.target = Reordered(clouds.target, clouds.target_order);
  const BlockTree tree(clouds.source.cast<float>());
  clouds.source_spacing = SurfaceSpacing(tree);
  clouds.source_normals = source.HasNormals() ? Reordered(source.normals, clouds.source_order)
                                              : EstimateNormals(tree, kernels);
  return clouds;
}

std::vector<int> LevelStrides(Eigen::Index larger_count) {
  constexpr int kCoarsestPoints = 500;
  constexpr int kRefinement = 8;
  int stride = 1;
  while (larger_count / (2 * stride) >= kCoarsestPoints) stride *= 2;
  std::vector<int> strides;
  // A level whose spacing is only twice that of the last one would cost more than it saves.
  for (; stride >= kRefinement / 2; stride /= kRefinement) strides.push_back(stride);
  strides.push_back(1);
  return strides;
}

int StrideFor(Eigen::Index count, Eigen::Index larger_count, int stride) {
  int own = stride;
  while (own > 1 && count / own < larger_count / stride) own /= 2;
  return own;
}

Eigen::Matrix3Xd EveryNth(const Eigen::Matrix3Xd& points, int stride) {
  if (stride == 1) return points;
  const Eigen::Index count = (points.cols() + stride - 1) / stride;
  Eigen::Matrix3Xd chosen(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    chosen.col(i) = points.col(std::min(points.cols() - 1, i * stride + stride / 2));
  }
  return chosen;
}

}  // namespace lacuna
