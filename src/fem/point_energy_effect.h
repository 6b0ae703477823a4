// An effect made from an additional elastic energy density at each material point.
//
// The energy density ψ(F, X, t) depends on the deformation gradient F, and may depend on the
// position X in the rest shape and on time. The law has no memory and no rate dependence, so it
// acts in statics as in dynamics. Forces, stiffness and energy follow by quadrature
// (point_integrals.h). A `Law` is a value type, made from the values of the parameters in the order
// of its card, SI:
//   static const EffectCard& Card();
//   explicit Law(const Eigen::VectorXd& parameters);
//   double EnergyDensity(const Matrix3d& F, const MaterialPoint& at) const;             ψ, J/m³
//   Matrix3d Stress(const Matrix3d& F, const MaterialPoint& at) const;                  ∂ψ/∂F, Pa
//   StressTangent Tangent(const Matrix3d& F, const MaterialPoint& at, bool convexify) const;
//                  ∂²ψ/∂F², Pa; with `convexify` a positive semi-definite approximation
//   Matrix3d StressDerivative(const Matrix3d& F, const MaterialPoint& at, int parameter) const;
//                  ∂(∂ψ/∂F)/∂p for a parameter p that is not a setting
#ifndef LACUNA_FEM_POINT_ENERGY_EFFECT_H_
#define LACUNA_FEM_POINT_ENERGY_EFFECT_H_

#include <glog/logging.h>

#include <Eigen/Core>
#include <optional>

#include "fem/cloneable_effect.h"
#include "fem/point_integrals.h"

namespace lacuna {

// The arguments of a law besides F.
struct MaterialPoint {
  Eigen::Vector3d position;  // X in the rest shape, m
  double time = 0;           // s
};

// The arguments of a law at a batch of points.
template <int kNodes>
class MaterialPoints {
 public:
  MaterialPoints(const Kinematics& at, int begin, int end)
      : at_(at), first_(begin * QuadraturePoints<kNodes>()), deformation_(at, begin, end) {}

  const Eigen::Matrix3d& F(int k) const { return deformation_.gradient[k]; }
  MaterialPoint Point(int k) const { return {at_.body.point.col(first_ + k), at_.time}; }

 private:
  const Kinematics& at_;
  int first_;
  DeformationGradients<kNodes> deformation_;
};

// The law as an effect: f_a = −Σ_q w_q (∂ψ/∂F) g_a, E = Σ_q w_q ψ. Parameters that its card marks
// as settings have no derivative (CHECK).
template <typename Law>
class PointEnergyEffect final : public CloneableEffect<PointEnergyEffect<Law>> {
 public:
  explicit PointEnergyEffect(const Eigen::VectorXd& parameters)
      : parameters_(parameters), law_(parameters) {}

  const EffectCard& Card() const override { return Law::Card(); }
  Eigen::VectorXd Parameters() const override { return parameters_; }
  void SetParameters(const Eigen::VectorXd& values) {
    CHECK_EQ(values.size(), parameters_.size());
    parameters_ = values;
    law_ = Law(values);
  }

  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    AddNodalForces<MaterialPoints>(
        at, [&](const auto& points, int k) { return law_.Stress(points.F(k), points.Point(k)); },
        force);
  }

  bool AddStress(const Kinematics& at, Eigen::Matrix3Xd* stress) const override {
    AddPointStress<MaterialPoints>(
        at, [&](const auto& points, int k) { return law_.Stress(points.F(k), points.Point(k)); },
        stress);
    return true;
  }

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    CHECK(parameter >= 0 && parameter < parameters_.size());
    CHECK(!Card().parameters[parameter].setting);
    AddNodalForces<MaterialPoints>(
        at,
        [&](const auto& points, int k) {
          return law_.StressDerivative(points.F(k), points.Point(k), parameter);
        },
        derivative);
  }

  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                   BlockMatrix* tangent) const override {
    if (weights.position == 0) return;
    AddStiffnessMatrix<MaterialPoints>(
        at, weights.position,
        [&](const auto& points, int k) {
          return law_.Tangent(points.F(k), points.Point(k), convexify);
        },
        tangent);
  }

  std::optional<double> Energy(const Kinematics& at) const override {
    return TotalEnergy<MaterialPoints>(at, [&](const auto& points, int k) {
      return law_.EnergyDensity(points.F(k), points.Point(k));
    });
  }

 private:
  Eigen::VectorXd parameters_;
  Law law_;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_POINT_ENERGY_EFFECT_H_
