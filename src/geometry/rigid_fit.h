// Least-squares fits of a rigid and of an affine motion to corresponding points.
#ifndef LACUNA_GEOMETRY_RIGID_FIT_H_
#define LACUNA_GEOMETRY_RIGID_FIT_H_

#include <Eigen/Geometry>

namespace lacuna {

// The principal axes along which a set of points has a significant extent, the largest first.
struct SpannedAxes {
  Eigen::Matrix3Xd axis;   // 3 × k, k ≤ 3, orthonormal
  Eigen::VectorXd extent;  // k, m: root of the sum of squared deviations from the mean
};
// The spanned axes of `points` (3 × n, m, n > 0); axes with less than a twentieth of the largest
// extent are omitted.
SpannedAxes AxesOf(const Eigen::Matrix3Xd& points);

struct RigidFit {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  // The dimension that the points span, which decides how much of the motion they determine:
  //   −1  no point: nothing
  //    0  one place: the translation only
  //    1  a line: all but the rotation about that line
  //    2  a plane or more: the whole motion
  // Undetermined parts of the motion are the identity.
  int span = -1;
};

// The motion R, t that minimises Σ_k |R from_k + t − to_k|² (S. Umeyama, IEEE PAMI 13, 1991,
// without scale). `from` and `to` are 3 × n, m. Pairs with a coordinate that is not finite are
// ignored.
RigidFit FitRigidMotion(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to);

// The affine motion that minimises the same sum, with stretch and shear only along the axes that
// the points span; across them it equals `rigid`, the result of FitRigidMotion for the same points.
Eigen::Affine3d FitAffineMotion(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to,
                                const RigidFit& rigid);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_RIGID_FIT_H_
