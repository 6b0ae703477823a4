// The deformation gradients and their rates at the quadrature points of a batch of elements
// (point_integrals.h), for laws that depend on the rate.
#ifndef LACUNA_FEM_DEFORMATION_RATES_H_
#define LACUNA_FEM_DEFORMATION_RATES_H_

#include <Eigen/Core>

#include "fem/effect.h"
#include "fem/element_kinematics.h"
#include "fem/point_integrals.h"

namespace lacuna {

// F and Ḟ (1/s) at the points of a batch.
template <int kNodes>
class DeformationRates {
 public:
  DeformationRates(const Kinematics& at, int begin, int end) : deformation_(at, begin, end) {
    for (int element = begin; element < end; ++element)
      FieldGradients<kNodes>(at.body, element, at.velocity,
                             rate_ + (element - begin) * QuadraturePoints<kNodes>());
  }

  const Eigen::Matrix3d& F(int k) const { return deformation_.gradient[k]; }
  const Eigen::Matrix3d& Rate(int k) const { return rate_[k]; }

 private:
  DeformationGradients<kNodes> deformation_;
  Eigen::Matrix3d rate_[DeformationGradients<kNodes>::kMost];
};

}  // namespace lacuna

#endif  // LACUNA_FEM_DEFORMATION_RATES_H_
