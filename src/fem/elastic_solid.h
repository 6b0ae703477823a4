// An effect made from a hyperelastic isotropic material law.
//
// The law gives the energy density ψ(F) of the deformation gradient F and its derivatives; nodal
// forces, stiffness and energy follow by quadrature (point_integrals.h). A `Law` is a small value
// type made from the Lamé constants λ and μ:
//   static const EffectCard& Card();            parameters young_modulus (Pa) and poisson_ratio
//   explicit Law(const LameConstants&);
//   double EnergyDensity(const Matrix3d& F) const;                 ψ, J/m³
//   Eigen::Matrix3d Stress(const Matrix3d& F) const;               P, Pa
//   <tangent> Tangent(const Matrix3d& F, bool convexify) const;    ∂P/∂F, Pa
// where P = ∂ψ/∂F is the first Piola–Kirchhoff stress. The tangent is a StressTangent or a type for
// which AddStiffness(tangent, …) is overloaded; with `convexify` it must be positive semi-definite.
// A law that needs the rotation R nearest to F declares EnergyDensity(F, R), Stress(F, R) and
// Tangent(F, R, convexify) instead, because computing rotations for many points at once is faster.
//
// ψ and P must be linear in (λ, μ). Then ∂P/∂E and ∂P/∂ν are the stresses of a law with ∂(λ, μ)/∂E
// and ∂(λ, μ)/∂ν in place of (λ, μ).
#ifndef LACUNA_FEM_ELASTIC_SOLID_H_
#define LACUNA_FEM_ELASTIC_SOLID_H_

#include <glog/logging.h>

#include <Eigen/Core>
#include <algorithm>
#include <optional>

#include "fem/cloneable_effect.h"
#include "fem/lame_constants.h"
#include "fem/point_integrals.h"
#include "fem/polar_decomposition.h"

namespace lacuna {

// Whether a law takes the rotation nearest to F as a second argument.
template <typename Law>
concept NeedsRotation = requires(const Law& law, const Eigen::Matrix3d& F) {
  law.Stress(F, F);
};

// The arguments of a law at a batch of points; rotations are computed only if the law needs them.
template <typename Law, int kNodes>
class BatchOfPoints {
 public:
  BatchOfPoints(const Kinematics& at, int begin, int end) : deformation_(at, begin, end) {
    if constexpr (NeedsRotation<Law>) {
      std::copy_n(deformation_.gradient, deformation_.points, rotation_);
      ReplaceByRotations(deformation_.points, rotation_);
    }
  }

  double EnergyDensity(const Law& law, int k) const {
    if constexpr (NeedsRotation<Law>) {
      return law.EnergyDensity(deformation_.gradient[k], rotation_[k]);
    } else {
      return law.EnergyDensity(deformation_.gradient[k]);
    }
  }

  Eigen::Matrix3d Stress(const Law& law, int k) const {
    if constexpr (NeedsRotation<Law>) {
      return law.Stress(deformation_.gradient[k], rotation_[k]);
    } else {
      return law.Stress(deformation_.gradient[k]);
    }
  }

  auto Tangent(const Law& law, int k, bool convexify) const {
    if constexpr (NeedsRotation<Law>) {
      return law.Tangent(deformation_.gradient[k], rotation_[k], convexify);
    } else {
      return law.Tangent(deformation_.gradient[k], convexify);
    }
  }

 private:
  DeformationGradients<kNodes> deformation_;
  Eigen::Matrix3d rotation_[NeedsRotation<Law> ? DeformationGradients<kNodes>::kMost : 1];
};

// The material law as an effect without memory: f_a = −Σ_q w_q P g_a, E = Σ_q w_q ψ. It does not
// depend on velocities and accelerations. A law that cannot be evaluated at a deformation gradient,
// for example because an element is inverted, gives values that are not finite.
template <typename Law>
class ElasticSolid final : public CloneableEffect<ElasticSolid<Law>> {
 public:
  // `parameters` holds Young's modulus in Pa and Poisson's ratio.
  explicit ElasticSolid(const Eigen::VectorXd& parameters) { SetParameters(parameters); }

  const EffectCard& Card() const override { return Law::Card(); }

  Eigen::VectorXd Parameters() const override {
    return Eigen::Vector2d(young_modulus_, poisson_ratio_);
  }

  void SetParameters(const Eigen::VectorXd& values) {
    CHECK_EQ(values.size(), 2);
    young_modulus_ = values[0];
    poisson_ratio_ = values[1];
  }

  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    AddForcesOf(Law(LameFromYoung(young_modulus_, poisson_ratio_)), at, force);
  }

  bool AddStress(const Kinematics& at, Eigen::Matrix3Xd* stress) const override {
    const Law law(LameFromYoung(young_modulus_, poisson_ratio_));
    AddPointStress<Points>(
        at, [&](const auto& points, int k) { return points.Stress(law, k); }, stress);
    return true;
  }

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    CHECK(parameter == 0 || parameter == 1);
    AddForcesOf(Law(parameter == 0 ? LameByYoungModulus(poisson_ratio_)
                                   : LameByPoissonRatio(young_modulus_, poisson_ratio_)),
                at, derivative);
  }

  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                   BlockMatrix* tangent) const override {
    if (weights.position == 0) return;
    const Law law(LameFromYoung(young_modulus_, poisson_ratio_));
    AddStiffnessMatrix<Points>(
        at, weights.position,
        [&](const auto& points, int k) { return points.Tangent(law, k, convexify); }, tangent);
  }

  std::optional<double> Energy(const Kinematics& at) const override {
    const Law law(LameFromYoung(young_modulus_, poisson_ratio_));
    return TotalEnergy<Points>(
        at, [&](const auto& points, int k) { return points.EnergyDensity(law, k); });
  }

 private:
  template <int kNodes>
  using Points = BatchOfPoints<Law, kNodes>;

  static void AddForcesOf(const Law& law, const Kinematics& at, Eigen::VectorXd* force) {
    AddNodalForces<Points>(
        at, [&](const auto& points, int k) { return points.Stress(law, k); }, force);
  }

  double young_modulus_ = 0;  // Pa
  double poisson_ratio_ = 0;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_ELASTIC_SOLID_H_
