// A continuous displacement field with its posterior uncertainty.
#ifndef LACUNA_REGISTRATION_DISPLACEMENT_FIELD_H_
#define LACUNA_REGISTRATION_DISPLACEMENT_FIELD_H_

#include <Eigen/Core>

#include "registration/gaussian_basis.h"

namespace lacuna {

// u(y) = scale · Σ_k c_k φ_k((y − centre) / scale), defined everywhere, together with the posterior
// covariance of its coefficients. An empty field (rank 0) is the displacement 0.
class DisplacementField {
 public:
  DisplacementField() = default;

  //   centre           m
  //   scale            m, the unit of length of the basis
  //   coefficients     3 × K, in units of `scale`
  //   covariance       K × K, covariance of the coefficients summed over the three axes; 0 × 0 if
  //                    unknown
  //   unseen_variance  prior variance, summed over the axes, of the part of the kernel that the
  //                    basis does not represent
  DisplacementField(const Eigen::Vector3d& centre, double scale, GaussianBasis basis,
                    Eigen::Matrix3Xd coefficients, Eigen::MatrixXd covariance,
                    double unseen_variance);

  bool IsEmpty() const { return basis_.Rank() == 0; }

  // The displacements (3 × n, m) at `points` (3 × n, m).
  Eigen::Matrix3Xd Evaluate(const Eigen::Matrix3Xd& points) const;

  // The posterior standard deviation (n, m) of the displacement at `points` (3 × n, m): the square
  // root of the trace of its 3 × 3 covariance. NaN if the covariance is unknown.
  Eigen::VectorXd StandardDeviation(const Eigen::Matrix3Xd& points) const;

 private:
  Eigen::Matrix3Xd Normalised(const Eigen::Matrix3Xd& points) const;

  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  double scale_ = 1.0;
  GaussianBasis basis_;
  Eigen::Matrix3Xd coefficients_;
  Eigen::MatrixXd covariance_;
  double unseen_variance_ = 0.0;
};

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_DISPLACEMENT_FIELD_H_
