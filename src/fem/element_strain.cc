#include "fem/element_strain.h"

#include <Eigen/Eigenvalues>

#include "fem/element_kinematics.h"

namespace lacuna {

ElementStrain MeanStrain(const Body& body, int element, const Eigen::VectorXd& position,
                         const Eigen::VectorXd& velocity) {
  return WithNodesPerElement(body, [&](auto nodes) {
    constexpr int kNodes = decltype(nodes)::value;
    constexpr int kPoints = QuadraturePoints<kNodes>();
    Eigen::Matrix3d F[kPoints], rate[kPoints];
    FieldGradients<kNodes>(body, element, position, F);
    FieldGradients<kNodes>(body, element, velocity, rate);
    ElementStrain mean;
    double volume = 0;
    for (int p = 0; p < kPoints; ++p) {
      const double weight = body.weight[element * kPoints + p];
      mean.strain += weight * GreenLagrangeStrain(F[p]);
      mean.rate += weight * StrainChange(F[p], rate[p]);
      volume += weight;
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
