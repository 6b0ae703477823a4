// The rigid motion that carries points nearest to where they were seen, and the affine one.
#ifndef LACUNA_GEOMETRY_RIGID_FIT_H_
#define LACUNA_GEOMETRY_RIGID_FIT_H_

#include <Eigen/Geometry>

namespace lacuna {

// The directions along which points have an extent, the largest first, and these extents: roots of
// the sums of squares, m. What is less than a twentieth of the largest is none.
struct SpannedAxes {
  Eigen::Matrix3Xd axis;
  Eigen::VectorXd extent;
};
SpannedAxes AxesOf(const Eigen::Matrix3Xd& points);

struct RigidFit {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  // What the points span, which tells how much of the motion they do: 0, a place alone, no turn; 1,
  // a line, no turn about it; 2, a plane or more, all of it; −1: none is seen, nothing. What they
  // do not tell is taken as none.
  int span = -1;
};

// Least squares (S. Umeyama, IEEE PAMI 13, 1991, without scale). `from`, `to`: 3 × n, m; a point
// that is not finite in either is left out.
RigidFit FitRigidMotion(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to);

// The same with a stretch and shear along what the points span, least squares too; across that it
// is `rigid`, their FitRigidMotion.
Eigen::Affine3d FitAffineMotion(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to,
                                const RigidFit& rigid);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_RIGID_FIT_H_
