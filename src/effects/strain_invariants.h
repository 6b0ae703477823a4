// Two measures of strain that are polynomials of F, without cancellation near the rest shape.
#ifndef LACUNA_EFFECTS_STRAIN_INVARIANTS_H_
#define LACUNA_EFFECTS_STRAIN_INVARIANTS_H_

#include <Eigen/Core>
#include <Eigen/LU>

namespace lacuna {

struct StrainInvariants {
  double distortion;  // F:F − 3 − 2 (J − 1), of second order in the strain
  double dilatation;  // J − 1
};

inline StrainInvariants InvariantsOf(const Eigen::Matrix3d& F) {
  const Eigen::Matrix3d H = F - Eigen::Matrix3d::Identity();
  const double trace = H.trace();
  const double second = 0.5 * (trace * trace - (H * H).trace());
  const double third = H.determinant();
  return {H.squaredNorm() - 2 * (second + third), trace + second + third};
}

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_STRAIN_INVARIANTS_H_
