// Detection of inverted or degenerate elements in a deformed body.
#ifndef LACUNA_FEM_INVERTED_ELEMENT_H_
#define LACUNA_FEM_INVERTED_ELEMENT_H_

#include <Eigen/Core>

#include "fem/body.h"

namespace lacuna {

// Returns an element whose Jacobian determinant det ∂x/∂X is not positive at one of its quadrature
// points when the nodes are at `position` (3n, node-major, m), or −1 if there is none. The element
// is identified by its number in the mesh from which the body was made (Body::given_element). A
// position that is not finite counts as an inversion.
int FindInvertedElement(const Body& body, const Eigen::VectorXd& position);

}  // namespace lacuna

#endif  // LACUNA_FEM_INVERTED_ELEMENT_H_
