// An effect made from a material law with memory, acting in parallel to the elasticity of a body.
//
//   f_a = −Σ_q w_q P_q g_a(q),    P = F dev Q + ⅓ (tr Q) cof F,    Q = m s(B; z, h),
// with the modulus m (Pa), which is the size of the effect, the strain B at the end of a time step
// of length h (branch_strain.h), and the internal variables z of the point at the start of the
// step. The stress derives from an incremental potential that is convex in B,
//   s = ∂w(B; z, h)/∂B,
// as in the variational updates of M. Ortiz and L. Stainier, CMAME 171, 1999. The algorithmic
// tangent is therefore symmetric, and the line search of Newton's method can descend on the
// potential. m w is the stored plus the dissipated energy density, up to a constant in each step.
//
// Choice of the strain measure. B and z refer to the reference configuration, so that the force
// follows any rotation. The power is exactly Q : Ḃ at any strain, so that a law that dissipates in
// (s, B) also does so in the body. No polar decomposition, logarithm or inverse of F is needed that
// could fail in a crushed or inverted element. A branch with a Poisson's ratio near 0.5 resists a
// change of volume, and a change of shape at constant volume as one with a smaller ratio does. The
// known weakness of the measure, a stiffness that vanishes under strong compression (P → 0 with F),
// matters less beside an elastic law that resists it. Since w is convex, only the geometric part of
// the tangent, in which Q stands, can make it indefinite; `convexify` removes the negative modes.
//
// z does not depend on m, so that sensitivities to m exist also for a branch with m = 0.
//
// A `Law` is a small value type that describes the branch for m = 1:
//   static const EffectCard& Card();                the first parameter is m
//   static constexpr int kStateSize;                numbers per point; 0 at rest
//   Law(const VectorXd& parameters, double time_step);            in the order of the card; h in s,
//                                                                 0 in statics
//   double Potential(const KelvinVector& B, const State& z) const;                 w
//   KelvinVector Stress(B, z) const;                                               s
//   KelvinMatrix Moduli(B, z) const;                                               ∂s/∂B
//   KelvinVector StressDerivative(B, z, int parameter) const;     ∂s/∂(parameter > 0, no setting)
//   State AtEnd(B, z) const;                                      z⁺, z at the end of the step
//   State AtEndDerivative(B, z, int parameter) const;             ∂z⁺/∂(parameter > 0, no setting)
//   KelvinVector StressChange(B, z, const State& dz) const;                        ∂s/∂z dz
//   State AtEndChange(B, z, const KelvinVector& dB, const State& dz) const;
//                                                                 ∂z⁺/∂B dB + ∂z⁺/∂z dz
// with State a Vector<double, kStateSize>. The derivatives at a limit are those of one branch
// (Effect::AddStateDerivatives).
#ifndef LACUNA_FEM_MEMORY_BRANCH_H_
#define LACUNA_FEM_MEMORY_BRANCH_H_

#include <glog/logging.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <optional>

#include "fem/branch_strain.h"
#include "fem/cloneable_effect.h"
#include "fem/point_integrals.h"
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
    const Law law = LawAt(at);
    AddNodalForces<Points>(
        at,
        [&](const auto& points, int k) {
          return StressOfBranch(points.F(k),
                                modulus * law.Stress(points.Strain(k), points.Memory(k)));
        },
        force);
  }

  bool AddStress(const Kinematics& at, Eigen::Matrix3Xd* stress) const override {
    const double modulus = Modulus();
    const Law law = LawAt(at);
    AddPointStress<Points>(
        at,
        [&](const auto& points, int k) {
          return StressOfBranch(points.F(k),
                                modulus * law.Stress(points.Strain(k), points.Memory(k)));
        },
        stress);
    return true;
  }

  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                   BlockMatrix* tangent) const override {
    if (weights.position == 0) return;
    const Law law = LawAt(at);
    AddStiffnessMatrix<Points>(
        at, weights.position * Modulus(),
        [&](const auto& points, int k) {
          const KelvinVector& strain = points.Strain(k);
          const State memory = points.Memory(k);
          StressTangent C =
              TangentOfBranch(points.F(k), law.Stress(strain, memory), law.Moduli(strain, memory));
          if (convexify && !IsPositiveSemidefinite(C)) C = PositivePart(C);
          return C;
        },
        tangent);
  }

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    CHECK(parameter >= 0 && parameter < parameters_.size());
    CHECK(!Card().parameters[parameter].setting);
    const double modulus = Modulus();
    const Law law = LawAt(at);
    const auto stress = [&](const KelvinVector& strain, const State& memory) {
      return parameter == 0
                 ? law.Stress(strain, memory)
                 : KelvinVector(modulus * law.StressDerivative(strain, memory, parameter));
    };
    AddNodalForces<Points>(
        at,
        [&](const auto& points, int k) {
          return StressOfBranch(points.F(k), stress(points.Strain(k), points.Memory(k)));
        },
        derivative);
  }

  std::optional<double> Energy(const Kinematics& at) const override {
    const Law law = LawAt(at);
    return Modulus() * TotalEnergy<Points>(at, [&](const auto& points, int k) {
             return law.Potential(points.Strain(k), points.Memory(k));
           });
  }

  Eigen::Index StateSize(const Body& body) const override {
    return static_cast<Eigen::Index>(Law::kStateSize) * body.PointCount();
  }
  void InitialState(const Body& body, Eigen::VectorXd* state) const override {
    *state = Eigen::VectorXd::Zero(StateSize(body));
  }
  void AdvanceState(const Kinematics& at, Eigen::VectorXd* state_at_end) const override {
    CHECK_EQ(state_at_end->size(), StateSize(at.body));
    const Law law = LawAt(at);
    ForEachPoint(at, [&](int q, const KelvinVector& strain, const State& memory) {
      MemoryOf(*state_at_end, q) = law.AtEnd(strain, memory);
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
    const Law law = LawAt(at);
    ForEachPoint(at, [&](int q, const KelvinVector& strain, const State& memory) {
      MemoryOf(change, q) += law.AtEndDerivative(strain, memory, parameter);
    });
  }

 private:
  using State = Eigen::Matrix<double, Law::kStateSize, 1>;

  double Modulus() const { return parameters_[0]; }  // m, Pa

  // The law of a step. CHECKs once for all points that there is a state for each.
  Law LawAt(const Kinematics& at) const {
    CHECK_EQ(at.state.size(), StateSize(at.body));
    return Law(parameters_, at.time_step);
  }

  // The internal variables of quadrature point q in a vector of those of all points.
  template <typename States>
  static auto MemoryOf(States& states, int q) {
    return states.template segment<Law::kStateSize>(Eigen::Index{Law::kStateSize} * q);
  }

  // The arguments of the law at the points of a batch (point_integrals.h): F, B, and z at the start
  // of the step, whose size LawAt checks.
  template <int kNodes>
  class Points {
   public:
    Points(const Kinematics& at, int begin, int end)
        : at_(at), first_(begin * QuadraturePoints<kNodes>()), deformation_(at, begin, end) {
      for (int k = 0; k < deformation_.points; ++k) strain_[k] = BranchStrain(F(k));
    }

    const Eigen::Matrix3d& F(int k) const { return deformation_.gradient[k]; }
    const KelvinVector& Strain(int k) const { return strain_[k]; }
    State Memory(int k) const { return MemoryOf(at_.state, first_ + k); }

   private:
    const Kinematics& at_;
    int first_;
    DeformationGradients<kNodes> deformation_;
    KelvinVector strain_[DeformationGradients<kNodes>::kMost];
  };

  // Calls visit(q, B, z) for each quadrature point q.
  template <typename Visit>
  static void ForEachPoint(const Kinematics& at, const Visit& visit) {
    WithNodesPerElement(at.body, [&](auto nodes) {
      constexpr int kPoints = QuadraturePoints<decltype(nodes)::value>();
      ForEachElement(*at.body.schedule, [&](int element) {
        const Points<decltype(nodes)::value> points(at, element, element + 1);
        for (int p = 0; p < kPoints; ++p)
          visit(element * kPoints + p, points.Strain(p), points.Memory(p));
      });
    });
  }

  // The tangent with its negative eigenvalues replaced by zero.
  static StressTangent PositivePart(const StressTangent& tangent) {
    const Eigen::SelfAdjointEigenSolver<StressTangent> modes(tangent);
    return modes.eigenvectors() * modes.eigenvalues().cwiseMax(0).asDiagonal() *
           modes.eigenvectors().transpose();
  }

  template <int kNodes>
  void AddStateDerivatives(const Kinematics& at, const Eigen::Ref<const Eigen::MatrixXd>& changes,
                           Eigen::Ref<Eigen::MatrixXd> forces) const {
    constexpr int kPoints = QuadraturePoints<kNodes>();
    const Law law = LawAt(at);
    ForEachElement(*at.body.schedule, [&](int element) {
      const Points<kNodes> points(at, element, element + 1);
      Eigen::Matrix3d weighted[kPoints];
      for (Eigen::Index k = 0; k < changes.cols(); ++k) {
        const auto change = changes.col(k);
        for (int p = 0; p < kPoints; ++p) {
          const int q = element * kPoints + p;
          weighted[p] =
              Modulus() * at.body.weight[q] *
              StressOfBranch(points.F(p), law.StressChange(points.Strain(p), points.Memory(p),
                                                           MemoryOf(change, q)));
        }
        AddPointForces<kNodes>(at.body, element, weighted, forces.col(k).data());
      }
    });
  }

  template <int kNodes>
  void AdvanceStateDerivatives(const Kinematics& at, const Eigen::Ref<const Eigen::MatrixXd>& moved,
                               Eigen::Ref<Eigen::MatrixXd> changes) const {
    constexpr int kPoints = QuadraturePoints<kNodes>();
    const Law law = LawAt(at);
    ForEachElement(*at.body.schedule, [&](int element) {
      const Points<kNodes> points(at, element, element + 1);
      Eigen::Matrix3d moved_F[kPoints];
      for (Eigen::Index k = 0; k < changes.cols(); ++k) {
        auto change = changes.col(k);
        FieldGradients<kNodes>(at.body, element, moved.col(k).data(), moved_F);
        for (int p = 0; p < kPoints; ++p) {
          auto own = MemoryOf(change, element * kPoints + p);
          own = law.AtEndChange(points.Strain(p), points.Memory(p),
                                BranchStrainChange(points.F(p), moved_F[p]), State(own));
        }
      }
    });
  }

  Eigen::VectorXd parameters_;  // in the order of the card
};

}  // namespace lacuna

#endif  // LACUNA_FEM_MEMORY_BRANCH_H_
