#include "fem/element_strain.h"

#include <Eigen/Eigenvalues>

#include "fem/point_integrals.h"

namespace lacuna {

ElementStrain MeanStrain(const Body& body, int element, const Eigen::VectorXd& position,
                         const Eigen::VectorXd& velocity) {
  return WithNodesPerElement(body, [&](auto nodes) {
    constexpr int kNodes = decltype(nodes)::value;
    constexpr int kPoints = QuadraturePoints<kNodes>();
    const Eigen::Matrix<double, 3, kNodes> x = GatherNodes<kNodes>(body, element, position);
    const Eigen::Matrix<double, 3, kNodes> v = GatherNodes<kNodes>(body, element, velocity);
    ElementStrain mean;
    double volume = 0;
    for (int q = element * kPoints; q < (element + 1) * kPoints; ++q) {
      const Eigen::Matrix3d F = FieldGradient<kNodes>(x, ShapeGradient<kNodes>(body, q));
      const Eigen::Matrix3d rate = FieldGradient<kNodes>(v, ShapeGradient<kNodes>(body, q));
      const Eigen::Matrix3d product = F.transpose() * rate;
      mean.strain += body.weight[q] * GreenLagrangeStrain(F);
      mean.rate += body.weight[q] * ToKelvin(0.5 * (product + product.transpose()));
      volume += body.weight[q];
    }
    mean.strain /= volume;
    mean.rate /= volume;
    return mean;
  });
}

double LargestPrincipal(const KelvinVector& tensor) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(FromKelvin(tensor), Eigen::EigenvaluesOnly)
      .eigenvalues()
      .cwiseAbs()
      .maxCoeff();
}

}  // namespace lacuna
