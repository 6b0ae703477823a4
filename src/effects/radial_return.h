// The radial return of a law that flows at a limit: the return mapping of von Mises plasticity (M.
// L. Wilkins, Calculation of Elastic-plastic Flow, 1964) and of a slider without a preferred
// direction.
//
// The trial value x, a strain or a stretch, is what a step without flow would lead to. Beyond the
// limit R it returns along itself:
//   r(x) = x for ‖x‖ ≤ R,    r(x) = (R/‖x‖) x otherwise,
// the nearest value within the limit. Its derivative is symmetric,
//   ∂r/∂x = I,    or    (R/‖x‖) (I − n nᵀ),   n = x/‖x‖,
// as r is the gradient of the convex potential ½ ‖x‖², or R (‖x‖ − ½ R). At the limit itself the
// derivative is that of no flow. Symmetric tensors are vectors in Kelvin's notation
// (fem/green_lagrange_strain.h), which keeps their norm.
#ifndef LACUNA_EFFECTS_RADIAL_RETURN_H_
#define LACUNA_EFFECTS_RADIAL_RETURN_H_

#include <Eigen/Core>

namespace lacuna {

// r(x), with R = `limit` > 0 in the unit of the trial value.
template <int kSize>
Eigen::Vector<double, kSize> RadialReturn(const Eigen::Vector<double, kSize>& trial, double limit) {
  const double norm = trial.norm();
  if (norm <= limit) return trial;
  return (limit / norm) * trial;
}

// The change ∂r/∂x dx of r(x) where x changes by dx.
template <int kSize>
Eigen::Vector<double, kSize> RadialReturnChange(const Eigen::Vector<double, kSize>& trial,
                                                double limit,
                                                const Eigen::Vector<double, kSize>& change) {
  const double norm = trial.norm();
  if (norm <= limit) return change;
  const Eigen::Vector<double, kSize> direction = trial / norm;
  return (limit / norm) * (change - direction.dot(change) * direction);
}

// ∂r/∂x.
template <int kSize>
Eigen::Matrix<double, kSize, kSize> RadialReturnDerivative(
    const Eigen::Vector<double, kSize>& trial, double limit) {
  using Matrix = Eigen::Matrix<double, kSize, kSize>;
  const double norm = trial.norm();
  if (norm <= limit) return Matrix::Identity();
  const Eigen::Vector<double, kSize> direction = trial / norm;
  return (limit / norm) * (Matrix::Identity() - direction * direction.transpose());
}

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_RADIAL_RETURN_H_
