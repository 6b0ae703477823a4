#include "geometry/rigid_fit.h"

#include <Eigen/SVD>
#include <vector>

namespace lacuna {
namespace {

// Points that are no wider than this part of their length lie on a line: their errors would make a
// turn about it twenty times the one that they make across.
constexpr double kWidth = 0.05;

std::vector<Eigen::Index> SeenInBoth(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to) {
  std::vector<Eigen::Index> seen;
  for (Eigen::Index k = 0; k < from.cols(); ++k)
    if (from.col(k).allFinite() && to.col(k).allFinite()) seen.push_back(k);
  return seen;
}

}  // namespace

RigidFit FitRigidMotion(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to) {
  const std::vector<Eigen::Index> seen = SeenInBoth(from, to);
  RigidFit fit;
  if (seen.empty()) return fit;
  const Eigen::Vector3d from_centre = from(Eigen::all, seen).rowwise().mean();
  const Eigen::Vector3d to_centre = to(Eigen::all, seen).rowwise().mean();
  const Eigen::Matrix3Xd a = from(Eigen::all, seen).colwise() - from_centre;
  const Eigen::Matrix3Xd b = to(Eigen::all, seen).colwise() - to_centre;
  const Eigen::JacobiSVD<Eigen::Matrix3Xd> shape(a, Eigen::ComputeThinU);
  const Eigen::VectorXd& extent = shape.singularValues();
  const double rounding = 1e-12 * (from_centre.norm() + to_centre.norm());
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  if (extent[0] <= rounding) {
    fit.span = 0;
  } else if (extent.size() == 1 || extent[1] <= kWidth * extent[0]) {
    fit.span = 1;
    const Eigen::Vector3d line = shape.matrixU().col(0);
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
  const std::vector<Eigen::Index> seen = SeenInBoth(from, to);
  Eigen::Affine3d motion(rigid.motion);
  if (rigid.span < 1) return motion;
  const Eigen::Vector3d from_centre = from(Eigen::all, seen).rowwise().mean();
  const Eigen::Vector3d to_centre = to(Eigen::all, seen).rowwise().mean();
  const Eigen::Matrix3Xd a = from(Eigen::all, seen).colwise() - from_centre;
  const Eigen::Matrix3Xd b = to(Eigen::all, seen).colwise() - to_centre;
  const Eigen::JacobiSVD<Eigen::Matrix3Xd> shape(a, Eigen::ComputeThinU | Eigen::ComputeThinV);
  Eigen::Matrix3d linear = rigid.motion.linear();
  for (Eigen::Index k = 0; k < shape.singularValues().size(); ++k) {
    const double extent = shape.singularValues()[k];
    if (extent <= kWidth * shape.singularValues()[0]) break;
    const Eigen::Vector3d along = shape.matrixU().col(k);
    linear +=
        (b * shape.matrixV().col(k) / extent - rigid.motion.linear() * along) * along.transpose();
  }
  motion.linear() = linear;
  motion.translation() = to_centre - linear * from_centre;
  return motion;
}

}  // namespace lacuna
