#include "geometry/rigid_fit.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/finite_columns.h"

namespace lacuna {
namespace {

// An extent below this fraction of the largest counts as none. The errors of points on a nearly
// straight line would cause a rotation about it that is twenty times the rotation across it.
constexpr double kWidth = 0.05;

Eigen::Matrix3Xd About(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& centre) {
  return points.colwise() - centre;
}

// Points and their images about the centroids of both, without those that are not finite.
struct CentredPairs {
  CentredPairs(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to) {
    const std::vector<Eigen::Index> seen = FiniteColumns(from + to);
    points = from(Eigen::all, seen);
    const Eigen::Matrix3Xd images = to(Eigen::all, seen);
    if (seen.empty()) return;
    from_centre = points.rowwise().mean();
    to_centre = images.rowwise().mean();
    a = About(points, from_centre);
    b = About(images, to_centre);
  }
  Eigen::Matrix3Xd points;  // of `from`
  Eigen::Matrix3Xd a, b;    // of `from` and of `to`, relative to their centroids
  Eigen::Vector3d from_centre = Eigen::Vector3d::Zero(), to_centre = Eigen::Vector3d::Zero();
};

}  // namespace

SpannedAxes AxesOf(const Eigen::Matrix3Xd& points) {
  // A decomposition of three rows wants three columns or more. Columns of zeros change nothing.
  Eigen::Matrix3Xd about = Eigen::Matrix3Xd::Zero(3, std::max<Eigen::Index>(3, points.cols()));
  about.leftCols(points.cols()) = About(points, points.rowwise().mean());
  const Eigen::JacobiSVD<Eigen::Matrix3Xd> shape(about, Eigen::ComputeThinU);
  const Eigen::VectorXd& extent = shape.singularValues();
  Eigen::Index count = 0;
  while (count < extent.size() && extent[count] > kWidth * extent[0]) ++count;
  return {shape.matrixU().leftCols(count), extent.head(count)};
}

RigidFit FitRigidMotion(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to) {
  const auto [points, a, b, from_centre, to_centre] = CentredPairs(from, to);
  RigidFit fit;
  if (points.cols() == 0) return fit;
  const SpannedAxes spanned = AxesOf(points);
  const double rounding = 1e-12 * (from_centre.norm() + to_centre.norm());
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  if (spanned.extent.size() == 0 || spanned.extent[0] <= rounding) {
    fit.span = 0;
  } else if (spanned.extent.size() == 1) {
    fit.span = 1;
    const Eigen::Vector3d line = spanned.axis.col(0);
    const Eigen::Vector3d carried = b * (a.transpose() * line);
    turn = Eigen::Quaterniond::FromTwoVectors(line, carried).toRotationMatrix();
  } else {
    fit.span = 2;
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(b * a.transpose(),
                                                Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d sign = Eigen::Vector3d::Ones();
    if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) sign[2] = -1;
    turn = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  }
  fit.motion.linear() = turn;
  fit.motion.translation() = to_centre - turn * from_centre;
  return fit;
}

Eigen::Affine3d FitAffineMotion(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to,
                                const RigidFit& rigid) {
  Eigen::Affine3d motion(rigid.motion);
  if (rigid.span < 1) return motion;
  const auto [points, a, b, from_centre, to_centre] = CentredPairs(from, to);
  const SpannedAxes spanned = AxesOf(points);
  Eigen::Matrix3d linear = rigid.motion.linear();
  for (Eigen::Index k = 0; k < spanned.extent.size(); ++k) {
    const Eigen::Vector3d along = spanned.axis.col(k);
    const Eigen::Vector3d image = b * (a.transpose() * along) / std::pow(spanned.extent[k], 2);
    linear += (image - rigid.motion.linear() * along) * along.transpose();
  }
  motion.linear() = linear;
  motion.translation() = to_centre - linear * from_centre;
  return motion;
}

}  // namespace lacuna
