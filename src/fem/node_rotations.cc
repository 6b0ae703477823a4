#include "fem/node_rotations.h"

#include <cmath>

#include "core/parallel.h"
#include "fem/element_kinematics.h"
#include "fem/polar_decomposition.h"

namespace lacuna {
namespace {

constexpr int kNodesPerTask = 512;

// Adds Σ w F over the quadrature points of the elements of each node. The nearest rotation does not
// depend on a positive factor, so the sum is not divided by the volume.
template <int kNodes>
void AddDeformationGradients(const Body& body, const Eigen::VectorXd& position,
                             std::vector<Eigen::Matrix3d>* sums) {
  ForEachElement(*body.schedule, [&](int element) {
    constexpr int kPoints = QuadraturePoints<kNodes>();
    Eigen::Matrix3d F[kPoints];
    FieldGradients<kNodes>(body, element, position, F);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (int p = 0; p < kPoints; ++p) sum += body.weight[element * kPoints + p] * F[p];
    for (int a = 0; a < kNodes; ++a) (*sums)[body.mesh.tets(a, element)] += sum;
  });
}

}  // namespace

std::vector<Eigen::Matrix3d> NodeRotations(const Body& body, const Eigen::VectorXd& position) {
  std::vector<Eigen::Matrix3d> rotations(body.NodeCount(), Eigen::Matrix3d::Zero());
  WithNodesPerElement(body, [&](auto nodes) {
    AddDeformationGradients<decltype(nodes)::value>(body, position, &rotations);
  });
  ParallelBlocks(body.NodeCount(), kNodesPerTask, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      const double size = rotations[i].norm();
      if (size > 0) rotations[i] *= std::sqrt(3.0) / size;
    }
    ReplaceByRotations(static_cast<int>(end - begin), &rotations[begin]);
  });
  return rotations;
}

}  // namespace lacuna
