#include "fem/inverted_element.h"

#include "fem/element_kinematics.h"

namespace lacuna {
namespace {

template <int kNodes>
int FirstInverted(const Body& body, const Eigen::VectorXd& position) {
  for (int e = 0; e < body.ElementCount(); ++e) {
    Eigen::Matrix3d gradients[QuadraturePoints<kNodes>()];
    FieldGradients<kNodes>(body, e, position, gradients);
    for (const Eigen::Matrix3d& F : gradients)
      if (!(F.determinant() > 0)) return body.given_element[e];
  }
  return -1;
}

}  // namespace

int FindInvertedElement(const Body& body, const Eigen::VectorXd& position) {
  return WithNodesPerElement(
      body, [&](auto nodes) { return FirstInverted<decltype(nodes)::value>(body, position); });
}

}  // namespace lacuna
