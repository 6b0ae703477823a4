// The strain of an element as a whole, for tables and pictures.
#ifndef LACUNA_FEM_ELEMENT_STRAIN_H_
#define LACUNA_FEM_ELEMENT_STRAIN_H_

#include <Eigen/Core>

#include "fem/body.h"
#include "fem/green_lagrange_strain.h"

namespace lacuna {

// Means over the element's quadrature points, by their volume: E = ½ (FᵀF − I) and
// Ė = sym(Fᵀ Ḟ), 1/s, with the nodes at `position` and moving with `velocity` (3n).
struct ElementStrain {
  KelvinVector strain = KelvinVector::Zero();
  KelvinVector rate = KelvinVector::Zero();
};
ElementStrain MeanStrain(const Body& body, int element, const Eigen::VectorXd& position,
                         const Eigen::VectorXd& velocity);

// The largest magnitude among the principal values.
double LargestPrincipal(const KelvinVector& tensor);

}  // namespace lacuna

#endif  // LACUNA_FEM_ELEMENT_STRAIN_H_
