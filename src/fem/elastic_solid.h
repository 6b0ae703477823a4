// A hyperelastic isotropic material law as an effect, from its energy density alone.
//
//   f_a = −∂E/∂x_a = −Σ_q w_q P(F_q) g_a(q),    E = Σ_q w_q ψ(F_q),    F = Σ_a x_a ⊗ g_a,
// with quadrature weights w_q and shape gradients g_a of the body and the first Piola–Kirchhoff
// stress P = ∂ψ/∂F (Bonet & Wood, Nonlinear Continuum Mechanics for Finite Element Analysis).
//
// A `Law` is a small value type, made from Lamé constants, in which ψ and P are *linear*:
//   static const EffectCard& Card();            parameters: young_modulus, poisson_ratio
//   explicit Law(const LameConstants&);
//   double EnergyDensity(const Matrix3d& F) const;                 ψ, J/m³
//   Eigen::Matrix3d Stress(const Matrix3d& F) const;               P, Pa
//   <tangent> Tangent(const Matrix3d& F, bool convexify) const;    ∂P/∂F, Pa: a StressTangent, or a
//                                type of its own for which AddStiffness(tangent, …) is overloaded
// A law that needs the rotation R nearest to F has Stress(F, R) and Tangent(F, R, convexify)
// instead: rotations are cheaper when they are found for many points at a time. Because of the
// linearity ∂P/∂E and ∂P/∂ν are the stresses of the law with ∂(λ, μ)/∂E and ∂(λ, μ)/∂ν in place of
// (λ, μ).
#ifndef LACUNA_FEM_ELASTIC_SOLID_H_
#define LACUNA_FEM_ELASTIC_SOLID_H_

#include <glog/logging.h>

#include <Eigen/Core>
#include <optional>

#include "fem/effect.h"
#include "fem/element_kinematics.h"
#include "fem/lame_constants.h"
#include "fem/stress_tangent.h"

namespace lacuna {

template <typename Law>
concept NeedsRotation = requires(const Law& law, const Eigen::Matrix3d& F) {
  law.Stress(F, F);
};

// What a law is evaluated for at the quadrature points of consecutive elements [begin, end), at
// most a batch. `k` counts them from the first one's.
template <typename Law, int kNodes>
class BatchOfPoints {
 public:
  BatchOfPoints(const Kinematics& at, int begin, int end) {
    int points = 0;
    for (int element = begin; element < end; ++element) {
      const Eigen::Matrix<double, 3, kNodes> x = GatherNodes<kNodes>(at.body, element, at.position);
      for (int p = 0; p < QuadraturePoints<kNodes>(); ++p) {
        const int q = element * QuadraturePoints<kNodes>() + p;
        gradient_[points] = FieldGradient<kNodes>(x, ShapeGradient<kNodes>(at.body, q));
        if constexpr (NeedsRotation<Law>) rotation_[points] = gradient_[points];
        ++points;
      }
    }
    if constexpr (NeedsRotation<Law>) ReplaceByRotations(points, rotation_);
  }

  Eigen::Matrix3d Stress(const Law& law, int k) const {
    if constexpr (NeedsRotation<Law>) {
      return law.Stress(gradient_[k], rotation_[k]);
    } else {
      return law.Stress(gradient_[k]);
    }
  }

  auto Tangent(const Law& law, int k, bool convexify) const {
    if constexpr (NeedsRotation<Law>) {
      return law.Tangent(gradient_[k], rotation_[k], convexify);
    } else {
      return law.Tangent(gradient_[k], convexify);
    }
  }

 private:
  static constexpr int kPoints = ElementSchedule::kElementsPerBatch * QuadraturePoints<kNodes>();
  Eigen::Matrix3d gradient_[kPoints];  // F
  Eigen::Matrix3d rotation_[NeedsRotation<Law> ? kPoints : 1];
};

template <typename Law>
class ElasticSolid final : public Effect {
 public:
  // `parameters`: Young's modulus in Pa, Poisson's ratio.
  explicit ElasticSolid(const Eigen::VectorXd& parameters) { SetParameters(parameters); }

  const EffectCard& Card() const override { return Law::Card(); }

  Eigen::VectorXd Parameters() const override {
    return Eigen::Vector2d(young_modulus_, poisson_ratio_);
  }

  void SetParameters(const Eigen::VectorXd& values) override {
    CHECK_EQ(values.size(), 2);
    young_modulus_ = values[0];
    poisson_ratio_ = values[1];
  }

  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    AddNodalStress(at, LameFromYoung(young_modulus_, poisson_ratio_), force);
  }

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    CHECK(parameter == 0 || parameter == 1);
    AddNodalStress(at,
                   parameter == 0 ? LameByYoungModulus(poisson_ratio_)
                                  : LameByPoissonRatio(young_modulus_, poisson_ratio_),
                   derivative);
  }

  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                   BlockMatrix* tangent) const override {
    if (weights.position == 0) return;
    if (at.body.mesh.Order() == 1) {
      AddStiffnessMatrix<4>(at, weights.position, convexify, tangent);
    } else {
      AddStiffnessMatrix<10>(at, weights.position, convexify, tangent);
    }
  }

  std::optional<double> Energy(const Kinematics& at) const override {
    return at.body.mesh.Order() == 1 ? TotalEnergy<4>(at) : TotalEnergy<10>(at);
  }

 private:
  // Adds −Σ w P g_a with the stress of the law for these constants.
  void AddNodalStress(const Kinematics& at, const LameConstants& constants,
                      Eigen::VectorXd* force) const {
    if (at.body.mesh.Order() == 1) {
      AddNodalStress<4>(at, constants, force);
    } else {
      AddNodalStress<10>(at, constants, force);
    }
  }

  template <int kNodes>
  static void AddNodalStress(const Kinematics& at, const LameConstants& constants,
                             Eigen::VectorXd* force) {
    const Law law(constants);
    const Body& body = at.body;
    constexpr int kPoints = QuadraturePoints<kNodes>();
    ForEachBatch(*body.schedule, [&](int begin, int end) {
      const BatchOfPoints<Law, kNodes> points(at, begin, end);
      for (int element = begin; element < end; ++element) {
        Eigen::Matrix<double, 3, kNodes> nodal = Eigen::Matrix<double, 3, kNodes>::Zero();
        for (int q = element * kPoints; q < (element + 1) * kPoints; ++q) {
          const Eigen::Matrix3d stress = points.Stress(law, q - begin * kPoints);
          nodal.noalias() -=
              (body.weight[q] * stress).lazyProduct(ShapeGradient<kNodes>(body, q).transpose());
        }
        ScatterNodes<kNodes>(body, element, nodal, force);
      }
    });
  }

  template <int kNodes>
  void AddStiffnessMatrix(const Kinematics& at, double weight, bool convexify,
                          BlockMatrix* tangent) const {
    const Law law(LameFromYoung(young_modulus_, poisson_ratio_));
    const Body& body = at.body;
    constexpr int kPoints = QuadraturePoints<kNodes>();
    ForEachBatch(*body.schedule, [&](int begin, int end) {
      const BatchOfPoints<Law, kNodes> points(at, begin, end);
      for (int element = begin; element < end; ++element) {
        ElementStiffness<kNodes> stiffness;
        stiffness.SetZero();
        for (int q = element * kPoints; q < (element + 1) * kPoints; ++q) {
          AddStiffness<kNodes>(points.Tangent(law, q - begin * kPoints, convexify),
                               ShapeGradient<kNodes>(body, q), -weight * body.weight[q],
                               &stiffness);
        }
        ScatterStiffness<kNodes>(body, element, stiffness, tangent);
      }
    });
  }

  template <int kNodes>
  double TotalEnergy(const Kinematics& at) const {
    const Law law(LameFromYoung(young_modulus_, poisson_ratio_));
    const Body& body = at.body;
    return SumOverElements(*body.schedule, [&](int element) {
      const Eigen::Matrix<double, 3, kNodes> x = GatherNodes<kNodes>(body, element, at.position);
      double energy = 0;
      for (int p = 0; p < QuadraturePoints<kNodes>(); ++p) {
        const int q = element * QuadraturePoints<kNodes>() + p;
        const Eigen::Matrix3d F = FieldGradient<kNodes>(x, ShapeGradient<kNodes>(body, q));
        energy += body.weight[q] * law.EnergyDensity(F);
      }
      return energy;
    });
  }

  double young_modulus_ = 0;  // Pa
  double poisson_ratio_ = 0;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_ELASTIC_SOLID_H_
