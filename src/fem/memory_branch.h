// An effect made from a material law with memory, acting in parallel to the elasticity of a body.
//
//   f_a = −Σ_q w_q P_q g_a(q),    P = F S,    S = m s(E; z, h),
// with the modulus m (Pa), which is the size of the effect, the Green–Lagrange strain E at the end
// of a time step of length h, and the internal variables z of the point at the start of the step.
// The stress derives from an incremental potential that is convex in E,
//   s = ∂w(E; z, h)/∂E,
// as in the variational updates of M. Ortiz and L. Stainier, CMAME 171, 1999. The algorithmic
// tangent is therefore symmetric, and the line search of Newton's method can descend on the
// potential. m w is the stored plus the dissipated energy density, up to a constant in each step.
//
// Choice of the strain measure. E and z refer to the reference configuration, so that the force
// follows any rotation. The power is exactly S : Ė at any strain, so that a law that dissipates in
// (s, E) also does so in the body. No polar decomposition, logarithm or inverse of F is needed that
// could fail in a crushed or inverted element. The known weakness of the measure, a stiffness that
// vanishes under strong compression (P = F S with F → 0), matters less beside an elastic law that
// resists it. Since w is convex, only the geometric part δF S of the tangent can make it
// indefinite, under pressure; `convexify` removes the negative modes.
//
// z does not depend on m, so that sensitivities to m exist also for a branch with m = 0.
//
// A `Law` is a small value type that describes the branch for m = 1:
//   static const EffectCard& Card();                the first parameter is m
//   static constexpr int kStateSize;                numbers per point; 0 at rest
//   Law(const VectorXd& parameters, double time_step);            in the order of the card; h in s,
//                                                                 0 in statics
//   double Potential(const KelvinVector& E, const State& z) const;                 w
//   KelvinVector Stress(E, z) const;                                               s
//   KelvinMatrix Moduli(E, z) const;                                               ∂s/∂E
//   KelvinVector StressDerivative(E, z, int parameter) const;     ∂s/∂(parameter > 0, no setting)
//   State AtEnd(E, z) const;                                      z⁺, z at the end of the step
//   KelvinVector StressByState(E, z, const State& dz) const;                       ∂s/∂z dz
//   State AtEndBy(E, z, const KelvinVector& dE, const State& dz) const;   ∂z⁺/∂E dE + ∂z⁺/∂z dz
//   State AtEndByParameter(E, z, int parameter) const;            ∂z⁺/∂(parameter > 0, no setting)
// with State a Vector<double, kStateSize>. The derivatives at a limit are those of one branch
// (Effect::AddStateDerivatives).
#ifndef LACUNA_FEM_MEMORY_BRANCH_H_
#define LACUNA_FEM_MEMORY_BRANCH_H_

#include <glog/logging.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <optional>

#include "fem/cloneable_effect.h"
#include "fem/element_kinematics.h"
#include "fem/green_lagrange_strain.h"
#include "fem/stress_tangent.h"

namespace lacuna {

// The branch as an effect. Its internal variables are those of all quadrature points one after
// another, kStateSize per point, and are 0 at rest. Energy() is the incremental potential of the
// current step, not the stored energy. Strains enter at the end of the step only, so there is no
// ∂f/∂v.
template <typename Law>
class MemoryBranch final : public CloneableEffect<MemoryBranch<Law>> {
 public:
  explicit MemoryBranch(const Eigen::VectorXd& parameters) { SetParameters(parameters); }

  const EffectCard& Card() const override { return Law::Card(); }
  Eigen::VectorXd Parameters() const override { return parameters_; }
  void SetParameters(const Eigen::VectorXd& values) {
    CHECK_EQ(values.size(), static_cast<Eigen::Index>(Card().parameters.size()));
    parameters_ = values;
  }

  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    const double modulus = Modulus();
    const Law law(parameters_, at.time_step);
    AddNodalForcesOf(
        at,
        [&](const KelvinVector& strain, const State& state) {
          return KelvinVector(modulus * law.Stress(strain, state));
        },
        force);
  }

  bool AddStress(const Kinematics& at, Eigen::Matrix3Xd* stress) const override {
    const double modulus = Modulus();
    const Law law(parameters_, at.time_step);
    ForEachPoint(at, [&](int q, const Eigen::Matrix3d& F) {
      stress->middleCols<3>(3 * q) +=
          modulus * F * FromKelvin(law.Stress(GreenLagrangeStrain(F), StateOf(at.state, q)));
    });
    return true;
  }

  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                   BlockMatrix* tangent) const override {
    if (weights.position == 0) return;
    WithNodesPerElement(at.body, [&](auto nodes) {
      AddStiffnessMatrix<decltype(nodes)::value>(at, weights.position, convexify, tangent);
    });
  }

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    CHECK(parameter >= 0 && parameter < parameters_.size());
    CHECK(!Card().parameters[parameter].setting);
    const double modulus = Modulus();
    const Law law(parameters_, at.time_step);
    AddNodalForcesOf(
        at,
        [&](const KelvinVector& strain, const State& state) {
          return parameter == 0
                     ? law.Stress(strain, state)
                     : KelvinVector(modulus * law.StressDerivative(strain, state, parameter));
        },
        derivative);
  }

  std::optional<double> Energy(const Kinematics& at) const override {
    return WithNodesPerElement(
        at.body, [&](auto nodes) { return TotalPotential<decltype(nodes)::value>(at); });
  }

  Eigen::Index StateSize(const Body& body) const override {
    return static_cast<Eigen::Index>(Law::kStateSize) * body.PointCount();
  }
  void InitialState(const Body& body, Eigen::VectorXd* state) const override {
    *state = Eigen::VectorXd::Zero(StateSize(body));
  }
  void AdvanceState(const Kinematics& at, Eigen::VectorXd* state_at_end) const override {
    CHECK_EQ(state_at_end->size(), StateSize(at.body));
    const Law law(parameters_, at.time_step);
    ForEachPoint(at, [&](int q, const Eigen::Matrix3d& F) {
      StateOf(*state_at_end, q) = law.AtEnd(GreenLagrangeStrain(F), StateOf(at.state, q));
    });
  }

  void AddStateDerivatives(const Kinematics& at, const Eigen::Ref<const Eigen::MatrixXd>& changes,
                           Eigen::Ref<Eigen::MatrixXd> forces) const override {
    WithNodesPerElement(at.body, [&](auto nodes) {
      AddStateDerivatives<decltype(nodes)::value>(at, changes, forces);
    });
  }
  void AdvanceStateDerivatives(const Kinematics& at, const Eigen::Ref<const Eigen::MatrixXd>& moved,
                               Eigen::Ref<Eigen::MatrixXd> changes) const override {
    WithNodesPerElement(at.body, [&](auto nodes) {
      AdvanceStateDerivatives<decltype(nodes)::value>(at, moved, changes);
    });
  }
  void AddStateByParameter(const Kinematics& at, int parameter,
                           Eigen::Ref<Eigen::VectorXd> change) const override {
    CHECK(parameter >= 0 && parameter < parameters_.size());
    CHECK(!Card().parameters[parameter].setting);
    if (parameter == 0) return;
    const Law law(parameters_, at.time_step);
    ForEachPoint(at, [&](int q, const Eigen::Matrix3d& F) {
      StateOf(change, q) +=
          law.AtEndByParameter(GreenLagrangeStrain(F), StateOf(at.state, q), parameter);
    });
  }

 private:
  using State = Eigen::Matrix<double, Law::kStateSize, 1>;

  double Modulus() const { return parameters_[0]; }  // m, Pa

  // The internal variables of quadrature point q in a vector of those of all points.
  template <typename States>
  static auto StateOf(States& states, int q) {
    return states.template segment<Law::kStateSize>(Eigen::Index{Law::kStateSize} * q);
  }

  // Calls visit(q, F) for each quadrature point q of an element, with its deformation gradient F.
  template <int kNodes, typename Visit>
  static void ForEachPoint(const Kinematics& at, int element, const Visit& visit) {
    constexpr int kPoints = QuadraturePoints<kNodes>();
    Eigen::Matrix3d F[kPoints];
    FieldGradients<kNodes>(at.body, element, at.position, F);
    for (int p = 0; p < kPoints; ++p) visit(element * kPoints + p, F[p]);
  }

  // Calls visit(q, F) for each quadrature point q of all elements.
  template <typename Visit>
  static void ForEachPoint(const Kinematics& at, const Visit& visit) {
    CHECK_EQ(at.state.size(), Eigen::Index{Law::kStateSize} * at.body.PointCount());
    WithNodesPerElement(at.body, [&](auto nodes) {
      ForEachElement(*at.body.schedule, [&](int element) {
        ForEachPoint<decltype(nodes)::value>(at, element, visit);
      });
    });
  }

  // Adds the nodal forces −Σ w F S g_a with S = stress(strain, state).
  template <typename Stress>
  void AddNodalForcesOf(const Kinematics& at, const Stress& stress, Eigen::VectorXd* force) const {
    CHECK_EQ(at.state.size(), StateSize(at.body));
    WithNodesPerElement(
        at.body, [&](auto nodes) { AddNodalForcesOf<decltype(nodes)::value>(at, stress, force); });
  }

  template <int kNodes, typename Stress>
  static void AddNodalForcesOf(const Kinematics& at, const Stress& stress, Eigen::VectorXd* force) {
    const Body& body = at.body;
    ForEachElement(*body.schedule, [&](int element) {
      constexpr int kPoints = QuadraturePoints<kNodes>();
      Eigen::Matrix3d weighted[kPoints];
      ForEachPoint<kNodes>(at, element, [&](int q, const Eigen::Matrix3d& F) {
        weighted[q - element * kPoints] =
            body.weight[q] * F * FromKelvin(stress(GreenLagrangeStrain(F), StateOf(at.state, q)));
      });
      AddPointForces<kNodes>(body, element, weighted, force);
    });
  }

  template <int kNodes>
  void AddStiffnessMatrix(const Kinematics& at, double weight, bool convexify,
                          BlockMatrix* tangent) const {
    CHECK_EQ(at.state.size(), StateSize(at.body));
    const Law law(parameters_, at.time_step);
    const Body& body = at.body;
    ForEachElement(*body.schedule, [&](int element) {
      ElementStiffness<kNodes> stiffness;
      stiffness.SetZero();
      ForEachPoint<kNodes>(at, element, [&](int q, const Eigen::Matrix3d& F) {
        const KelvinVector strain = GreenLagrangeStrain(F);
        const State state = StateOf(at.state, q);
        StressTangent C =
            TangentOfSecondStress(F, law.Stress(strain, state), law.Moduli(strain, state));
        if (convexify && !IsPositiveSemidefinite(C)) C = PositivePart(C);
        AddStiffness<kNodes>(C, ShapeGradient<kNodes>(body, q),
                             -weight * body.weight[q] * Modulus(), &stiffness);
      });
      ScatterStiffness<kNodes>(body, element, stiffness, tangent);
    });
  }

  // The tangent with its negative eigenvalues replaced by zero.
  static StressTangent PositivePart(const StressTangent& tangent) {
    const Eigen::SelfAdjointEigenSolver<StressTangent> modes(tangent);
    return modes.eigenvectors() * modes.eigenvalues().cwiseMax(0).asDiagonal() *
           modes.eigenvectors().transpose();
  }

  template <int kNodes>
  double TotalPotential(const Kinematics& at) const {
    CHECK_EQ(at.state.size(), StateSize(at.body));
    const Law law(parameters_, at.time_step);
    const double sum = SumOverElements(*at.body.schedule, [&](int element) {
      double potential = 0;
      ForEachPoint<kNodes>(at, element, [&](int q, const Eigen::Matrix3d& F) {
        potential +=
            at.body.weight[q] * law.Potential(GreenLagrangeStrain(F), StateOf(at.state, q));
      });
      return potential;
    });
    return Modulus() * sum;
  }

  // Calls visit(element, F, strain) for each element, with the deformation gradients and the
  // strains at its points.
  template <int kNodes, typename Visit>
  static void ForEachStrainedElement(const Kinematics& at, const Visit& visit) {
    CHECK_EQ(at.state.size(), Eigen::Index{Law::kStateSize} * at.body.PointCount());
    constexpr int kPoints = QuadraturePoints<kNodes>();
    ForEachElement(*at.body.schedule, [&](int element) {
      Eigen::Matrix3d F[kPoints];
      KelvinVector strain[kPoints];
      FieldGradients<kNodes>(at.body, element, at.position, F);
      for (int p = 0; p < kPoints; ++p) strain[p] = GreenLagrangeStrain(F[p]);
      visit(element, F, strain);
    });
  }

  template <int kNodes>
  void AddStateDerivatives(const Kinematics& at, const Eigen::Ref<const Eigen::MatrixXd>& changes,
                           Eigen::Ref<Eigen::MatrixXd> forces) const {
    constexpr int kPoints = QuadraturePoints<kNodes>();
    const Law law(parameters_, at.time_step);
    const auto add = [&](int element, const Eigen::Matrix3d* F, const KelvinVector* strain) {
      Eigen::Matrix3d weighted[kPoints];
      for (Eigen::Index k = 0; k < changes.cols(); ++k) {
        const auto change = changes.col(k);
        for (int p = 0; p < kPoints; ++p) {
          const int q = element * kPoints + p;
          weighted[p] =
              Modulus() * at.body.weight[q] * F[p] *
              FromKelvin(law.StressByState(strain[p], StateOf(at.state, q), StateOf(change, q)));
        }
        AddPointForces<kNodes>(at.body, element, weighted, forces.col(k).data());
      }
    };
    ForEachStrainedElement<kNodes>(at, add);
  }

  template <int kNodes>
  void AdvanceStateDerivatives(const Kinematics& at, const Eigen::Ref<const Eigen::MatrixXd>& moved,
                               Eigen::Ref<Eigen::MatrixXd> changes) const {
    constexpr int kPoints = QuadraturePoints<kNodes>();
    const Law law(parameters_, at.time_step);
    const auto advance = [&](int element, const Eigen::Matrix3d* F, const KelvinVector* strain) {
      Eigen::Matrix3d by[kPoints];
      for (Eigen::Index k = 0; k < changes.cols(); ++k) {
        auto change = changes.col(k);
        FieldGradients<kNodes>(at.body, element, moved.col(k).data(), by);
        for (int p = 0; p < kPoints; ++p) {
          const int q = element * kPoints + p;
          StateOf(change, q) = law.AtEndBy(strain[p], StateOf(at.state, q),
                                           StrainChange(F[p], by[p]), State(StateOf(change, q)));
        }
      }
    };
    ForEachStrainedElement<kNodes>(at, advance);
  }

  Eigen::VectorXd parameters_;  // in the order of the card
};

}  // namespace lacuna

#endif  // LACUNA_FEM_MEMORY_BRANCH_H_
