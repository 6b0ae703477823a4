#include "scan/camera_alignment.h"

#include <fmt/format.h>
#include <glog/logging.h>
#include <pcl/features/normal_3d.h>
#include <pcl/point_types.h>
#include <pcl/registration/correspondence_rejection_surface_normal.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/transformation_estimation.h>
#include <pcl/search/kdtree.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "geometry/rotation.h"

namespace lacuna {
namespace {

using Cloud = pcl::PointCloud<pcl::PointNormal>;
using Icp = pcl::IterativeClosestPoint<pcl::PointNormal, pcl::PointNormal, double>;

// PCL computes in single precision, so coordinates are taken relative to the common centre.
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

// Measures the distances that ICP minimises: those of mutually nearest points of the two views
// along the sum of their normals.
PairDistance MeasurePairs(const Cloud::Ptr& source, const Cloud::Ptr& target, double max_distance,
                          double max_angle) {
  pcl::search::KdTree<pcl::PointNormal> source_tree, target_tree;
  source_tree.setInputCloud(source);
  target_tree.setInputCloud(target);
  PairDistance result;
  double sum = 0;
  std::vector<int> there(1), back(1);
  std::vector<float> squared(1);
  for (size_t i = 0; i < source->size(); ++i) {
    const pcl::PointNormal& point = (*source)[i];
    if (target_tree.nearestKSearch(point, 1, there, squared) != 1) continue;
    const pcl::PointNormal& other = (*target)[there[0]];
    const float cosine = point.getNormalVector3fMap().dot(other.getNormalVector3fMap());
    if (squared[0] > max_distance * max_distance || cosine < std::cos(max_angle)) continue;
    if (source_tree.nearestKSearch(other, 1, back, squared) != 1) continue;
    if (back[0] != static_cast<int>(i)) continue;
    const Eigen::Vector3f normal =
        (point.getNormalVector3fMap() + other.getNormalVector3fMap()).normalized();
    const float distance = (point.getVector3fMap() - other.getVector3fMap()).dot(normal);
    sum += distance * distance;
    ++result.pairs;
  }
  if (result.pairs > 0) result.rms = std::sqrt(sum / result.pairs);
  return result;
}

// The step of ICP: minimises Σ ((ω × p + t + p − q)·n)², where n is the normalised sum of the two
// normals, but only along those directions of motion that the pairs determine. Along the others (a
// plane that slides along itself, a sphere that rotates) the step is zero and the pose stays as it
// was given ("solution remapping", Zhang, Kaess & Singh 2016).
class DeterminedMotionEstimation
    : public pcl::registration::TransformationEstimation<pcl::PointNormal, pcl::PointNormal,
                                                         double> {
 public:
  DeterminedMotionEstimation(double min_stiffness, int* free_directions)
      : min_stiffness_(min_stiffness), free_directions_(free_directions) {}

  void estimateRigidTransformation(const Cloud& source, const Cloud& target,
                                   const pcl::Correspondences& pairs,
                                   Matrix4& matrix) const override {
    matrix.setIdentity();
    if (pairs.empty()) return;
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    for (const auto& pair : pairs) center += Position(source[pair.index_query]);
    center /= static_cast<double>(pairs.size());
    double squared_radius = 0;
    for (const auto& pair : pairs) {
      squared_radius += (Position(source[pair.index_query]) - center).squaredNorm();
    }
    // Rotations are multiplied by this distance, so that all six components are lengths.
    const double radius = std::sqrt(squared_radius / static_cast<double>(pairs.size()));
    using Matrix6d = Eigen::Matrix<double, 6, 6>;
    using Vector6d = Eigen::Matrix<double, 6, 1>;
    Matrix6d stiffness = Matrix6d::Zero();
    Vector6d force = Vector6d::Zero();
    for (const auto& pair : pairs) {
      const pcl::PointNormal& p = source[pair.index_query];
      const pcl::PointNormal& q = target[pair.index_match];
      const Eigen::Vector3d normal =
          (p.getNormalVector3fMap() + q.getNormalVector3fMap()).cast<double>().normalized();
      Vector6d row;
      row << (Position(p) - center).cross(normal) / radius, normal;
      stiffness += row * row.transpose();
      force -= row * (Position(p) - Position(q)).dot(normal);
    }
    const Eigen::SelfAdjointEigenSolver<Matrix6d> modes(stiffness);
    Vector6d step = Vector6d::Zero();
    *free_directions_ = 0;
    for (int i = 0; i < 6; ++i) {
      const double value = modes.eigenvalues()[i];
      if (!(value > min_stiffness_ * static_cast<double>(pairs.size()))) {
        ++*free_directions_;
        continue;
      }
      const Vector6d mode = modes.eigenvectors().col(i);
      step += mode * (mode.dot(force) / value);
    }
    const Eigen::Vector3d rotation = step.head<3>() / radius;
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.linear() = RotationBy(rotation);
    motion.translation() = center + step.tail<3>() - motion.linear() * center;
    matrix = motion.matrix();
  }

  // PCL's ICP calls only the form above.
  void estimateRigidTransformation(const Cloud&, const Cloud&, Matrix4&) const override {
    LOG(FATAL) << "not used";
  }
  void estimateRigidTransformation(const Cloud&, const pcl::Indices&, const Cloud&,
                                   Matrix4&) const override {
    LOG(FATAL) << "not used";
  }
  void estimateRigidTransformation(const Cloud&, const pcl::Indices&, const Cloud&,
                                   const pcl::Indices&, Matrix4&) const override {
    LOG(FATAL) << "not used";
  }

 private:
  static Eigen::Vector3d Position(const pcl::PointNormal& point) {
    return point.getVector3fMap().cast<double>();
  }

  double min_stiffness_;
  int* free_directions_;  // not owned
};

struct Fit {
  bool converged = false;
  int free_directions = 0;
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
};

Fit FitByIcp(const Cloud::Ptr& source, const Cloud::Ptr& target, double max_distance,
             const AlignmentOptions& options) {
  Fit fit;
  Icp icp;
  auto rejector = std::make_shared<pcl::registration::CorrespondenceRejectorSurfaceNormal>();
  rejector->setThreshold(std::cos(options.max_angle));
  icp.addCorrespondenceRejector(rejector);
  icp.setTransformationEstimation(
      std::make_shared<DeterminedMotionEstimation>(options.min_stiffness, &fit.free_directions));
  icp.setInputSource(source);
  icp.setInputTarget(target);
  // Without this, points beyond the border of the other view would pull towards that border.
  icp.setUseReciprocalCorrespondences(true);
  icp.setMaxCorrespondenceDistance(max_distance);
  icp.setMaximumIterations(options.iterations);
  // A view that slides along the others hardly changes the mean squared distance of the pairs, so
  // the fit counts as converged only when the motion itself no longer changes.
  icp.getConvergeCriteria()->setRelativeMSE(-1);
  icp.getConvergeCriteria()->setAbsoluteMSE(-1);
  icp.setTransformationEpsilon(1e-12);
  Cloud aligned;
  icp.align(aligned);
  const Eigen::Matrix4d matrix = icp.getFinalTransformation();
  fit.converged = icp.hasConverged() && matrix.allFinite();
  if (!fit.converged) return fit;
  // A product of many rotations is a rotation only up to rounding.
  fit.motion.linear() = Eigen::Quaterniond(matrix.topLeftCorner<3, 3>()).normalized().matrix();
  fit.motion.translation() = matrix.topRightCorner<3, 1>();
  return fit;
}

// The views of all cameras while they are registered to one another.
struct Views {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Matrix3Xd centroids;              // centroid of each view, relative to the centre
  std::vector<Cloud::Ptr> clouds;          // relative to the centre, by the given poses
  std::vector<Eigen::Isometry3d> motions;  // motion of each cloud so far
};

Views MakeViews(const std::vector<Eigen::Matrix3Xd>& clouds, const Eigen::Matrix3Xd& positions,
                int neighbours) {
  Views views;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Index count = 0;
  for (const Eigen::Matrix3Xd& cloud : clouds) {
    sum += cloud.rowwise().sum();
    count += cloud.cols();
  }
  views.center = sum / count;
  views.centroids.resize(3, clouds.size());
  for (size_t i = 0; i < clouds.size(); ++i) {
    views.centroids.col(i) = clouds[i].rowwise().mean() - views.center;
    views.clouds.push_back(ToPcl(clouds[i], views.center, positions.col(i), neighbours));
  }
  views.motions.assign(clouds.size(), Eigen::Isometry3d::Identity());
  return views;
}

// The first `count` views without view `left_out`.
Cloud::Ptr Others(const Views& views, size_t left_out, size_t count) {
  auto merged = std::make_shared<Cloud>();
  for (size_t i = 0; i < count; ++i) {
    if (i != left_out) *merged += *Moved(*views.clouds[i], views.motions[i]);
  }
  return merged;
}

PairDistance MeasureView(const Views& views, size_t i, size_t count,
                         const AlignmentOptions& options) {
  return MeasurePairs(Moved(*views.clouds[i], views.motions[i]), Others(views, i, count),
                      options.max_distance, options.max_angle);
}

// Registers view i to the others once.
void RegisterView(size_t i, int sweep, const AlignmentOptions& options, Views* views,
                  CameraCorrection* correction) {
  // Views with wrong poses would pull in wrong directions. In the first sweep, only those already
  // registered count, provided that they overlap enough.
  const size_t all = views->clouds.size();
  size_t count = sweep == 0 ? i : all;
  int pairs = MeasureView(*views, i, count, options).pairs;
  if (pairs < options.min_pairs) pairs = MeasureView(*views, i, count = all, options).pairs;
  if (pairs < options.min_pairs) {
    correction->message =
        fmt::format("not applied: {} pairs overlap, fewer than {}", pairs, options.min_pairs);
    return;
  }
  const double max_distance =
      std::max(std::ldexp(options.max_distance, -sweep), 0.25 * options.max_distance);
  const Fit fit = FitByIcp(Moved(*views->clouds[i], views->motions[i]), Others(*views, i, count),
                           max_distance, options);
  if (!fit.converged) {
    correction->message = "not applied: ICP did not converge";
    return;
  }
  const Eigen::Isometry3d motion = fit.motion * views->motions[i];
  const Eigen::Vector3d centroid = views->centroids.col(i);
  const double distance = (motion * centroid - centroid).norm();
  if (distance > options.max_distance) {
    correction->message =
        fmt::format("not applied: ICP would move the view by {:g} m, further than {:g} m", distance,
                    options.max_distance);
    return;
  }
  views->motions[i] = motion;
  correction->applied = true;
  correction->translation = distance;
  correction->free_directions = fit.free_directions;
}

}  // namespace

std::vector<CameraCorrection> AlignCameras(const std::vector<Eigen::Matrix3Xd>& clouds,
                                           const Eigen::Matrix3Xd& positions,
                                           const AlignmentOptions& options) {
  const size_t count = clouds.size();
  CHECK_EQ(positions.cols(), static_cast<Eigen::Index>(count));
  std::vector<CameraCorrection> corrections(count);
  if (clouds.empty()) return corrections;
  corrections[0].message = "keeps its pose: the others are aligned to it";
  const bool sees_too_few = std::any_of(clouds.begin(), clouds.end(), [&](const auto& cloud) {
    return cloud.cols() < options.neighbours;
  });
  if (sees_too_few) {
    for (size_t i = 1; i < count; ++i) {
      corrections[i].message = "not applied: a camera sees too few points";
    }
    return corrections;
  }
  Views views = MakeViews(clouds, positions, options.neighbours);
  for (size_t i = 1; i < count; ++i) {
    corrections[i].rms_before = MeasureView(views, i, count, options).rms;
  }
  for (int sweep = 0; sweep < options.sweeps; ++sweep) {
    for (size_t i = 1; i < count; ++i) {
      RegisterView(i, sweep, options, &views, &corrections[i]);
    }
  }
  for (size_t i = 1; i < count; ++i) {
    CameraCorrection& correction = corrections[i];
    if (!correction.applied) continue;
    correction.rms_after = MeasureView(views, i, count, options).rms;
    correction.angle = Eigen::AngleAxisd(views.motions[i].linear()).angle();
    correction.correction =
        Eigen::Translation3d(views.center) * views.motions[i] * Eigen::Translation3d(-views.center);
    correction.message = "applied";
  }
  return corrections;
}

}  // namespace lacuna
