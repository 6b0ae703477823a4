#include "scan/camera_alignment.h"

#include <fmt/format.h>
#include <glog/logging.h>
#include <pcl/features/normal_3d.h>
#include <pcl/point_types.h>
#include <pcl/registration/correspondence_rejection_surface_normal.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/transformation_estimation_point_to_plane_lls.h>
#include <pcl/search/kdtree.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lacuna {
namespace {

using Cloud = pcl::PointCloud<pcl::PointNormal>;
using Icp = pcl::IterativeClosestPoint<pcl::PointNormal, pcl::PointNormal, double>;

// Single precision in PCL: coordinates are taken about the common centre.
Cloud::Ptr ToPcl(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& center,
                 const Eigen::Vector3d& sensor, int neighbours) {
  auto cloud = std::make_shared<Cloud>();
  cloud->resize(points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    (*cloud)[i].getVector3fMap() = (points.col(i) - center).cast<float>();
  }
  pcl::NormalEstimation<pcl::PointNormal, pcl::PointNormal> estimation;
  estimation.setInputCloud(cloud);
  estimation.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointNormal>>());
  estimation.setKSearch(neighbours);
  const Eigen::Vector3f view = (sensor - center).cast<float>();
  estimation.setViewPoint(view.x(), view.y(), view.z());
  estimation.compute(*cloud);
  auto finite = std::make_shared<Cloud>();
  for (const pcl::PointNormal& point : *cloud) {
    if (point.getNormalVector3fMap().allFinite()) finite->push_back(point);
  }
  return finite;
}

Cloud::Ptr Moved(const Cloud& cloud, const Eigen::Isometry3d& motion) {
  auto moved = std::make_shared<Cloud>(cloud);
  for (pcl::PointNormal& point : *moved) {
    point.getVector3fMap() =
        (motion * Eigen::Vector3d(point.getVector3fMap().cast<double>())).cast<float>();
    point.getNormalVector3fMap() =
        (motion.linear() * point.getNormalVector3fMap().cast<double>()).cast<float>();
  }
  return moved;
}

struct PairDistance {
  int pairs = 0;
  double rms = -1;
};

// The point-to-plane distances of the pairs that ICP would use.
PairDistance MeasurePairs(const Cloud& source, const Cloud::Ptr& target,
                          const AlignmentOptions& options) {
  pcl::search::KdTree<pcl::PointNormal> tree;
  tree.setInputCloud(target);
  PairDistance result;
  double sum = 0;
  std::vector<int> index(1);
  std::vector<float> squared(1);
  for (const pcl::PointNormal& point : source) {
    if (tree.nearestKSearch(point, 1, index, squared) != 1) continue;
    const pcl::PointNormal& other = (*target)[index[0]];
    const float cosine = point.getNormalVector3fMap().dot(other.getNormalVector3fMap());
    if (squared[0] > options.max_distance * options.max_distance ||
        cosine < std::cos(options.max_angle)) {
      continue;
    }
    const float distance =
        (point.getVector3fMap() - other.getVector3fMap()).dot(other.getNormalVector3fMap());
    sum += distance * distance;
    ++result.pairs;
  }
  if (result.pairs > 0) result.rms = std::sqrt(sum / result.pairs);
  return result;
}

struct Fit {
  bool converged = false;
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
};

Fit FitByIcp(const Cloud::Ptr& source, const Cloud::Ptr& target, const AlignmentOptions& options) {
  Icp icp;
  auto rejector = std::make_shared<pcl::registration::CorrespondenceRejectorSurfaceNormal>();
  rejector->setThreshold(std::cos(options.max_angle));
  icp.addCorrespondenceRejector(rejector);
  icp.setTransformationEstimation(
      std::make_shared<pcl::registration::TransformationEstimationPointToPlaneLLS<
          pcl::PointNormal, pcl::PointNormal, double>>());
  icp.setInputSource(source);
  icp.setInputTarget(target);
  // Without this, points beyond the border of the other view would pull towards that border.
  icp.setUseReciprocalCorrespondences(true);
  icp.setMaxCorrespondenceDistance(options.max_distance);
  icp.setMaximumIterations(options.iterations);
  Cloud aligned;
  icp.align(aligned);
  const Eigen::Matrix4d matrix = icp.getFinalTransformation();
  Fit fit;
  fit.converged = icp.hasConverged() && matrix.allFinite();
  if (!fit.converged) return fit;
  // The linearised steps leave a rotation that is one only to rounding.
  fit.motion.linear() = Eigen::Quaterniond(matrix.topLeftCorner<3, 3>()).normalized().matrix();
  fit.motion.translation() = matrix.topRightCorner<3, 1>();
  return fit;
}

Cloud::Ptr AllBut(const std::vector<Cloud::Ptr>& clouds,
                  const std::vector<Eigen::Isometry3d>& motions, size_t left_out) {
  auto merged = std::make_shared<Cloud>();
  for (size_t i = 0; i < clouds.size(); ++i) {
    if (i != left_out) *merged += *Moved(*clouds[i], motions[i]);
  }
  return merged;
}

}  // namespace

std::vector<CameraCorrection> AlignCameras(const std::vector<Eigen::Matrix3Xd>& clouds,
                                           const Eigen::Matrix3Xd& positions,
                                           const AlignmentOptions& options) {
  CHECK_EQ(positions.cols(), static_cast<Eigen::Index>(clouds.size()));
  std::vector<CameraCorrection> corrections(clouds.size());
  if (clouds.empty()) return corrections;
  corrections[0].message = "stands still: the others are aligned to it";
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Index count = 0;
  for (const Eigen::Matrix3Xd& cloud : clouds) {
    if (cloud.cols() < options.neighbours) {
      for (size_t i = 1; i < clouds.size(); ++i) {
        corrections[i].message = "not applied: a camera sees too few points";
      }
      return corrections;
    }
    sum += cloud.rowwise().sum();
    count += cloud.cols();
  }
  const Eigen::Vector3d center = sum / count;

  std::vector<Cloud::Ptr> views;
  for (size_t i = 0; i < clouds.size(); ++i) {
    views.push_back(ToPcl(clouds[i], center, positions.col(i), options.neighbours));
  }
  std::vector<Eigen::Isometry3d> motions(clouds.size(), Eigen::Isometry3d::Identity());
  std::vector<PairDistance> before(clouds.size());
  for (size_t i = 1; i < clouds.size(); ++i) {
    before[i] = MeasurePairs(*views[i], AllBut(views, motions, i), options);
    corrections[i].rms_before = before[i].rms;
  }
  for (int sweep = 0; sweep < options.sweeps; ++sweep) {
    for (size_t i = 1; i < clouds.size(); ++i) {
      if (before[i].pairs < options.min_pairs) {
        corrections[i].message = fmt::format("not applied: {} pairs overlap, fewer than {}",
                                             before[i].pairs, options.min_pairs);
        continue;
      }
      const Cloud::Ptr others = AllBut(views, motions, i);
      const Fit fit = FitByIcp(Moved(*views[i], motions[i]), others, options);
      if (!fit.converged) {
        corrections[i].message = "not applied: ICP did not converge";
        continue;
      }
      const Eigen::Isometry3d motion = fit.motion * motions[i];
      const double moved = (motion * Eigen::Vector3d(clouds[i].rowwise().mean() - center) -
                            (clouds[i].rowwise().mean() - center))
                               .norm();
      if (moved > options.max_distance) {
        corrections[i].message =
            fmt::format("not applied: ICP would move the view by {:g} m, further than {:g} m",
                        moved, options.max_distance);
        continue;
      }
      motions[i] = motion;
      corrections[i].applied = true;
      corrections[i].translation = moved;
    }
  }
  for (size_t i = 1; i < clouds.size(); ++i) {
    CameraCorrection& correction = corrections[i];
    if (!correction.applied) continue;
    const Cloud::Ptr others = AllBut(views, motions, i);
    correction.rms_after = MeasurePairs(*Moved(*views[i], motions[i]), others, options).rms;
    if (!(correction.rms_after < correction.rms_before)) {
      correction.applied = false;
      correction.translation = 0;
      correction.message = "not applied: it does not bring the surfaces nearer";
      motions[i].setIdentity();
      continue;
    }
    correction.angle = Eigen::AngleAxisd(motions[i].linear()).angle();
    correction.correction =
        Eigen::Translation3d(center) * motions[i] * Eigen::Translation3d(-center);
    correction.message = "applied";
  }
  return corrections;
}

}  // namespace lacuna
