#include "fem/inverted_element.h"

#include "fem/element_kinematics.h"

namespace lacuna {
namespace {

template <int kNodes>
int FirstInverted(const Body& body, const Eigen::VectorXd& position) {
  for (int e = 0; e < body.ElementCount(); ++e) {
    const Eigen::Matrix<double, 3, kNodes> x = GatherNodes<kNodes>(body, e, position);
    for (int q = e * body.points_per_element; q < (e + 1) * body.points_per_element; ++q) {
      const Eigen::Matrix3d F = FieldGradient<kNodes>(x, ShapeGradient<kNodes>(body, q));
      if (!(F.determinant() > 0)) return body.given_element[e];
    }
  }
  return -1;
}

}  // namespace

int FindInvertedElement(const Body& body, const Eigen::VectorXd& position) {
  return WithNodesPerElement(
      body, [&](auto nodes) { return FirstInverted<decltype(nodes)::value>(body, position); });
}

}  // namespace lacuna
