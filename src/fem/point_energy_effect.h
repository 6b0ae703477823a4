// An effect that is an additional elastic energy density at each material point, of the body's
// rest shape and of time besides the deformation gradient F.
//
// A `Law` is a value type, made from the values of its card's parameters, in their order, SI:
//   static const EffectCard& Card();
//   explicit Law(const Eigen::VectorXd& parameters);
//   double EnergyDensity(const Matrix3d& F, const MaterialPoint& at) const;             ψ, J/m³
//   Matrix3d Stress(const Matrix3d& F, const MaterialPoint& at) const;                  ∂ψ/∂F, Pa
//   StressTangent Tangent(const Matrix3d& F, const MaterialPoint& at, bool convexify) const;
//                  ∂²ψ/∂F², Pa; with `convexify` a positive semi-definite stand-in
//   Matrix3d StressDerivative(const Matrix3d& F, const MaterialPoint& at, int parameter) const;
//                  of the stress by a parameter that is no setting
// Forces, stiffness and energy follow as in point_integrals.h. The law has no memory, and so acts
// the same in statics.
#ifndef LACUNA_FEM_POINT_ENERGY_EFFECT_H_
#define LACUNA_FEM_POINT_ENERGY_EFFECT_H_

#include <glog/logging.h>

#include <Eigen/Core>
#include <optional>

#include "fem/cloneable_effect.h"
#include "fem/point_integrals.h"

namespace lacuna {

struct MaterialPoint {
  Eigen::Vector3d position;  // in the rest shape, m
  double time = 0;           // s
};

// What a law is evaluated for at a batch of points.
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
