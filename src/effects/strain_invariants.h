// Two measures of strain that are polynomials of the deformation gradient F and therefore defined
// for any F. They are evaluated from F − I, so that no digits cancel near the rest shape:
//   F:F − 3 − 2 (J − 1) = H:H − 2 (II_H + III_H),   J − 1 = I_H + II_H + III_H,
// with H = F − I, its principal invariants I_H, II_H, III_H, and J = det F.
#ifndef LACUNA_EFFECTS_STRAIN_INVARIANTS_H_
#define LACUNA_EFFECTS_STRAIN_INVARIANTS_H_

#include <Eigen/Core>
#include <Eigen/LU>

namespace lacuna {

struct StrainInvariants {
  double distortion;  // F:F − 3 − 2 (J − 1), which is of second order in the strain
  double dilatation;  // J − 1
};

// F may be any matrix, also that of an inverted element.
inline StrainInvariants InvariantsOf(const Eigen::Matrix3d& F) {
  const Eigen::Matrix3d H = F - Eigen::Matrix3d::Identity();
  const double trace = H.trace();
  const double second = 0.5 * (trace * trace - (H * H).trace());
  const double third = H.determinant();
  return {H.squaredNorm() - 2 * (second + third), trace + second + third};
}

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_STRAIN_INVARIANTS_H_
