#include "registration/motion_step.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace lacuna {
namespace {

// Normals transform with the cofactor matrix of F (Nanson's formula).
Eigen::Matrix3d Cofactors(const Eigen::Matrix3d& f) {
  Eigen::Matrix3d cofactors;
  cofactors << f.col(1).cross(f.col(2)), f.col(2).cross(f.col(0)), f.col(0).cross(f.col(1));
  return cofactors;
}

}  // namespace

Pull PullOf(const SourceSurface& source, const std::vector<Eigen::Matrix3d>& deformation_gradients,
            const Posterior& posterior, double sigma, const MotionObjective& objective) {
  const int count = static_cast<int>(source.normals.cols());
  const int size = source.patches.size;
  const double epsilon = objective.tangential_weight;
  Pull pull;
  pull.force.resize(3, count);
  pull.weights.resize(source.patches.Count());
  std::vector<double> squared_residual(source.patches.Count());
  constexpr int kPatchesPerTask = 32;
  ParallelFor(source.patches.Count(), kPatchesPerTask, [&](int64_t q) {
    const Eigen::Matrix3d turn = Cofactors(deformation_gradients[q]);
    Eigen::Matrix3d weights = Eigen::Matrix3d::Zero();
    double squared = 0.0;
    for (int m = static_cast<int>(q) * size; m < std::min<int>(count, (q + 1) * size); ++m) {
      const double weight = posterior.weight[m];
      const Eigen::Vector3d shift = posterior.shift.col(m).cast<double>();
      const Eigen::Vector3d turned = turn * source.normals.col(m);
      const double length = turned.norm();
      const bool has_normal = length > 0.0;
      const double isotropic = weight * (has_normal ? epsilon : 1.0);
      const double directed = weight * (has_normal ? 1.0 - epsilon : 0.0);
      const Eigen::Vector3d normal = has_normal ? (turned / length).eval() : turned;
      const double residual = normal.dot(shift) - source.curvature_bias[m] * sigma * sigma;
      squared += weight * residual * residual;
      pull.force.col(m) = (directed * residual * normal + isotropic * shift).cast<float>();
      weights += directed * normal * normal.transpose();
      weights.diagonal().array() += isotropic;
    }
    squared_residual[q] = squared;
    pull.weights[q] << weights(0, 0), weights(0, 1), weights(0, 2), weights(1, 1), weights(1, 2),
        weights(2, 2);
  });
  double sum = 0.0;
  for (const double squared : squared_residual) sum += squared;
  pull.residual = std::sqrt(sum / std::max(posterior.total_weight, 1e-30));
  return pull;
}

namespace {

// Σ_q w_q φ̄_q φ̄_qᵀ for the six entries of the patches' weights, lower halves.
template <typename Real>
void SumWeightedProducts(const Patches& patches, const Pull& pull, Eigen::MatrixXd blocks[6]) {
  using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  const Matrix basis = patches.mean_basis.cast<Real>();
  const Eigen::Index rank = basis.rows();
  ParallelFor(6, 1, [&](int64_t entry) {
    Eigen::Matrix<Real, 1, Eigen::Dynamic> weights(patches.Count());
    for (int q = 0; q < patches.Count(); ++q) {
      weights[q] = static_cast<Real>(pull.weights[q][entry]);
    }
    const Matrix weighted = basis * weights.asDiagonal();
    Matrix product = Matrix::Zero(rank, rank);
    product.template triangularView<Eigen::Lower>() = basis * weighted.transpose();
    blocks[entry] = product.template cast<double>();
  });
}

}  // namespace

Eigen::MatrixXd MotionHessian(const SourceSurface& source, const Pull& pull,
                              const Eigen::MatrixXd& rigidity_hessian,
                              const MotionObjective& objective) {
  const Eigen::Index rank = source.patches.mean_basis.rows();
  Eigen::MatrixXd blocks[6];
  if (source.patches.is_fine) {
    SumWeightedProducts<double>(source.patches, pull, blocks);
  } else {
    SumWeightedProducts<float>(source.patches, pull, blocks);
  }
  Eigen::MatrixXd hessian = objective.rigidity * rigidity_hessian;
  hessian.diagonal().array() += objective.coherence;
  int entry = 0;
  for (int b = 0; b < 3; ++b) {
    for (int a = b; a < 3; ++a, ++entry) {
      const Eigen::MatrixXd block = blocks[entry].selfadjointView<Eigen::Lower>();
      hessian.block(a * rank, b * rank, rank, rank) += block;
    }
  }
  return hessian;
}

Eigen::Matrix3Xd MotionStep(const SourceSurface& source, const BasisTable& table, const Pull& pull,
                            const Eigen::Matrix3Xd& coefficients,
                            const std::vector<Eigen::Matrix3d>& deformation_gradients,
                            const MotionObjective& objective,
                            const Eigen::LLT<Eigen::MatrixXd>& hessian) {
  Eigen::Matrix3Xd descent = table.Project(pull.force) - objective.coherence * coefficients;
  if (objective.rigidity > 0.0) {
    descent -= objective.rigidity * RigidityGradient(source.patches, deformation_gradients);
  }
  const Eigen::Index rank = coefficients.cols();
  Eigen::MatrixXd by_axis = descent.transpose();  // K × 3: the order (axis, k) in memory
  const Eigen::VectorXd step = hessian.solve(by_axis.reshaped());
  return step.reshaped(rank, 3).transpose();
}

}  // namespace lacuna
