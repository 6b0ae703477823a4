#include "scan/filter.h"

#include <fmt/format.h>
#include <glog/logging.h>
#include <pcl/features/normal_3d_omp.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "geometry/nearest.h"
#include "geometry/tri_mesh.h"

namespace lacuna {
namespace {

using Cloud = pcl::PointCloud<pcl::PointNormal>;
constexpr Eigen::Index kFewestPoints = 4;

struct Points {
  PointCloud cloud;
  Eigen::VectorXi seen_by;  // empty if unknown

  Points Select(const std::vector<int>& kept) const {
    Points selected;
    selected.cloud.points = cloud.points(Eigen::all, kept);
    selected.cloud.normals = Eigen::Matrix3Xd(3, 0);
    if (cloud.HasNormals()) selected.cloud.normals = cloud.normals(Eigen::all, kept);
    if (seen_by.size() > 0) selected.seen_by = seen_by(kept);
    return selected;
  }
};

Cloud::Ptr ToPcl(const PointCloud& cloud, const Eigen::Vector3d& center) {
  auto converted = std::make_shared<Cloud>();
  converted->resize(cloud.Size());
  for (Eigen::Index i = 0; i < cloud.Size(); ++i) {
    (*converted)[i].getVector3fMap() = (cloud.points.col(i) - center).cast<float>();
    if (cloud.HasNormals()) {
      (*converted)[i].getNormalVector3fMap() = cloud.normals.col(i).cast<float>();
    }
  }
  return converted;
}

Points RemoveOutliers(const Points& points, const Eigen::Vector3d& center,
                      const FilterOptions& options) {
  pcl::StatisticalOutlierRemoval<pcl::PointNormal> filter;
  filter.setInputCloud(ToPcl(points.cloud, center));
  filter.setMeanK(options.outlier_neighbours);
  filter.setStddevMulThresh(options.outlier_deviations);
  std::vector<int> kept;
  filter.filter(kept);
  return points.Select(kept);
}

void CheckVoxel(const Points& points, double voxel_size) {
  const Eigen::Array3d cells =
      (BoundingBox(points.cloud.points).sizes().array() / voxel_size).floor() + 2;
  if (cells.prod() >= std::numeric_limits<int>::max()) {
    throw InputError(
        fmt::format("a voxel of {:g} m divides the cloud into {:g} cubes, more than "
                    "can be numbered; choose a larger one",
                    voxel_size, cells.prod()));
  }
}

// Replaces the points in each cube by their mean, seen by the sensor of the point nearest to it.
Points MergeByVoxel(const Points& points, const Eigen::Vector3d& center, double voxel_size) {
  CheckVoxel(points, voxel_size);
  pcl::VoxelGrid<pcl::PointNormal> grid;
  grid.setInputCloud(ToPcl(points.cloud, center));
  const float size = static_cast<float>(voxel_size);
  grid.setLeafSize(size, size, size);
  Cloud means;
  grid.filter(means);
  Points merged;
  const Eigen::Index count = static_cast<Eigen::Index>(means.size());
  merged.cloud.points.resize(3, count);
  merged.cloud.normals.resize(3, points.cloud.HasNormals() ? count : 0);
  for (Eigen::Index i = 0; i < count; ++i) {
    merged.cloud.points.col(i) = means[i].getVector3fMap().cast<double>() + center;
    if (points.cloud.HasNormals()) {
      merged.cloud.normals.col(i) = means[i].getNormalVector3fMap().cast<double>();
    }
  }
  if (points.seen_by.size() > 0) {
    const PointHits hits = PointSearch(points.cloud.points).Nearest(merged.cloud.points, 1);
    merged.seen_by = points.seen_by(Eigen::VectorXi(hits.index.row(0)));
  }
  return merged;
}

Eigen::Matrix3Xd EstimateNormals(const PointCloud& cloud, const Eigen::Vector3d& center,
                                 int neighbours) {
  pcl::NormalEstimationOMP<pcl::PointNormal, pcl::Normal> estimation(ThreadCount());
  estimation.setInputCloud(ToPcl({cloud.points, Eigen::Matrix3Xd(3, 0)}, center));
  estimation.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointNormal>>());
  estimation.setKSearch(static_cast<int>(std::min<Eigen::Index>(neighbours, cloud.Size())));
  pcl::PointCloud<pcl::Normal> estimated;
  estimation.compute(estimated);
  Eigen::Matrix3Xd normals(3, cloud.Size());
  for (Eigen::Index i = 0; i < cloud.Size(); ++i) {
    normals.col(i) = estimated[i].getNormalVector3fMap().cast<double>();
  }
  return normals;
}

void RequireEnoughPoints(const Points& points, Eigen::Index input_count) {
  if (points.cloud.Size() >= kFewestPoints) return;
  throw InputError(fmt::format("{} of {} points are left after filtering; expected at least {}",
                               points.cloud.Size(), input_count, kFewestPoints));
}

// Drops points whose normal is not finite or vanishes, as the mean of opposite normals in a cube
// does.
Points DropWithoutNormal(Points points) {
  std::vector<int> kept;
  for (int i = 0; i < points.cloud.Size(); ++i) {
    const double length = points.cloud.normals.col(i).norm();
    if (!std::isfinite(length) || length < 1e-6) continue;
    points.cloud.normals.col(i) /= length;
    kept.push_back(i);
  }
  return points.Select(kept);
}

}  // namespace

FilterResult FilterCloud(const PointCloud& cloud, const Sensors& sensors,
                         const FilterOptions& options) {
  CHECK(cloud.points.allFinite());
  FilterResult result;
  result.input_count = cloud.Size();
  result.sensors.positions = sensors.positions;
  Points points{cloud, sensors.seen_by};
  if (options.renew_normals) points.cloud.normals.resize(3, 0);
  RequireEnoughPoints(points, result.input_count);
  const Eigen::Vector3d center = cloud.points.rowwise().mean();

  if (options.outlier_neighbours > 0) {
    points = RemoveOutliers(points, center, options);
    result.outlier_count = result.input_count - points.cloud.Size();
    RequireEnoughPoints(points, result.input_count);
  }
  if (options.voxel_size > 0) {
    const Eigen::Index before = points.cloud.Size();
    points = MergeByVoxel(points, center, options.voxel_size);
    result.merged_count = before - points.cloud.Size();
    RequireEnoughPoints(points, result.input_count);
  }
  const bool has_normals = points.cloud.HasNormals();
  if (!has_normals) {
    points.cloud.normals = EstimateNormals(points.cloud, center, options.normal_neighbours);
  }
  const Eigen::Index before = points.cloud.Size();
  points = DropWithoutNormal(std::move(points));
  result.degenerate_count = before - points.cloud.Size();
  RequireEnoughPoints(points, result.input_count);

  result.sensors.seen_by = points.seen_by;
  result.cloud = std::move(points.cloud);
  if (has_normals) {
    result.orientation.method = OrientationMethod::kGiven;
  } else {
    result.orientation = OrientNormals(result.cloud.points, result.sensors,
                                       options.normal_neighbours, &result.cloud.normals);
  }
  return result;
}

}  // namespace lacuna
