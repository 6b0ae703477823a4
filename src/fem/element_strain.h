// The mean strain of an element, for tables and figures.
//
// The strain is Green–Lagrange's E = ½ (FᵀF − I), and its rate is Ė = sym(Fᵀ Ḟ), both in Kelvin's
// notation (green_lagrange_strain.h).
#ifndef LACUNA_FEM_ELEMENT_STRAIN_H_
#define LACUNA_FEM_ELEMENT_STRAIN_H_

#include <Eigen/Core>

#include "fem/body.h"
#include "fem/green_lagrange_strain.h"

namespace lacuna {

struct ElementStrain {
  KelvinVector strain = KelvinVector::Zero();  // E
  KelvinVector rate = KelvinVector::Zero();    // Ė, 1/s
};

// Averages strain and rate over the quadrature points of an element, weighted by volume, for nodes
// at `position` (3n, node-major, m) that move with `velocity` (3n, m/s).
ElementStrain MeanStrain(const Body& body, int element, const Eigen::VectorXd& position,
                         const Eigen::VectorXd& velocity);

// The largest absolute principal value of a symmetric tensor.
double LargestPrincipal(const KelvinVector& tensor);

}  // namespace lacuna

#endif  // LACUNA_FEM_ELEMENT_STRAIN_H_
