// Nodal forces, stiffness matrix and energy of a body by quadrature, from the first Piola–Kirchhoff
// stress P, its tangent ∂P/∂F and the energy density ψ at the quadrature points:
//   f_a = −Σ_q w_q P_q g_a(q),    ∂f_a/∂x_b = −Σ_q w_q K_ab(q),    E = Σ_q w_q ψ_q
// with quadrature weights w_q and shape gradients g_a of the body (Bonet & Wood, Nonlinear
// Continuum Mechanics for Finite Element Analysis); stress_tangent.h defines K_ab.
//
// Laws are evaluated for batches of points, since some are faster for many points at once. For the
// elements [begin, end), at most ElementSchedule::kElementsPerBatch, an object Points<kNodes>(at,
// begin, end) is constructed, and a function passed to these templates is called as
// function(points, k) for the k-th point of the batch. The calls run on several threads; the
// results do not depend on their number.
#ifndef LACUNA_FEM_POINT_INTEGRALS_H_
#define LACUNA_FEM_POINT_INTEGRALS_H_

#include <Eigen/Core>

#include "fem/effect.h"
#include "fem/element_kinematics.h"
#include "fem/stress_tangent.h"

namespace lacuna {

// The deformation gradients F at the points of a batch.
template <int kNodes>
struct DeformationGradients {
  DeformationGradients(const Kinematics& at, int begin, int end) {
    for (int element = begin; element < end; ++element) {
      FieldGradients<kNodes>(at.body, element, at.position, gradient + points);
      points += QuadraturePoints<kNodes>();
    }
  }

  // The largest number of points in a batch.
  static constexpr int kMost = ElementSchedule::kElementsPerBatch * QuadraturePoints<kNodes>();
  int points = 0;
  Eigen::Matrix3d gradient[kMost];
};

// Adds the nodal forces f_a to `force` (3n, N); stress(points, k) returns P in Pa.
template <template <int> class Points, typename Stress>
void AddNodalForces(const Kinematics& at, const Stress& stress, Eigen::VectorXd* force) {
  WithNodesPerElement(at.body, [&](auto nodes) {
    constexpr int kNodes = decltype(nodes)::value;
    constexpr int kPoints = QuadraturePoints<kNodes>();
    ForEachBatch(*at.body.schedule, [&](int begin, int end) {
      const Points<kNodes> points(at, begin, end);
      for (int element = begin; element < end; ++element) {
        Eigen::Matrix3d weighted[kPoints];
        for (int p = 0; p < kPoints; ++p)
          weighted[p] = at.body.weight[element * kPoints + p] *
                        stress(points, (element - begin) * kPoints + p);
        AddPointForces<kNodes>(at.body, element, weighted, force);
      }
    });
  });
}

// Adds P to `stress` (3 × 3·points, Pa; columns 3q to 3q + 2 at point q).
template <template <int> class Points, typename Stress>
void AddPointStress(const Kinematics& at, const Stress& stress_of, Eigen::Matrix3Xd* stress) {
  WithNodesPerElement(at.body, [&](auto nodes) {
    constexpr int kNodes = decltype(nodes)::value;
    constexpr int kPoints = QuadraturePoints<kNodes>();
    ForEachBatch(*at.body.schedule, [&](int begin, int end) {
      const Points<kNodes> points(at, begin, end);
      for (int q = begin * kPoints; q < end * kPoints; ++q)
        stress->middleCols<3>(3 * q) += stress_of(points, q - begin * kPoints);
    });
  });
}

// Adds weight · ∂f/∂x to `tangent`. tangent_of(points, k) returns ∂P/∂F in Pa as a StressTangent,
// or as a type for which AddStiffness(tangent, …) is overloaded. A law that depends on the rate Ḟ
// may return a weighted sum a ∂P/∂F + b ∂P/∂Ḟ instead, for which a ∂f/∂x + b ∂f/∂v is added. What
// is returned must be symmetric, or skew-symmetric with kMirror = −1: the tangent of a law without
// a potential has both parts.
template <template <int> class Points, int kMirror = 1, typename TangentOf>
void AddStiffnessMatrix(const Kinematics& at, double weight, const TangentOf& tangent_of,
                        BlockMatrix* tangent) {
  WithNodesPerElement(at.body, [&](auto nodes) {
    constexpr int kNodes = decltype(nodes)::value;
    constexpr int kPoints = QuadraturePoints<kNodes>();
    ForEachBatch(*at.body.schedule, [&](int begin, int end) {
      const Points<kNodes> points(at, begin, end);
      for (int element = begin; element < end; ++element) {
        ElementStiffness<kNodes> stiffness;
        stiffness.SetZero();
        for (int q = element * kPoints; q < (element + 1) * kPoints; ++q) {
          AddStiffness<kNodes>(tangent_of(points, q - begin * kPoints),
                               ShapeGradient<kNodes>(at.body, q), -weight * at.body.weight[q],
                               &stiffness);
        }
        ScatterStiffness<kNodes, kMirror>(at.body, element, stiffness, tangent);
      }
    });
  });
}

// The energy E in J; density(points, k) returns ψ in J/m³.
template <template <int> class Points, typename Density>
double TotalEnergy(const Kinematics& at, const Density& density) {
  return WithNodesPerElement(at.body, [&](auto nodes) {
    constexpr int kNodes = decltype(nodes)::value;
    constexpr int kPoints = QuadraturePoints<kNodes>();
    return SumOverElements(*at.body.schedule, [&](int element) {
      const Points<kNodes> points(at, element, element + 1);
      double energy = 0;
      for (int p = 0; p < kPoints; ++p) {
        energy += at.body.weight[element * kPoints + p] * density(points, p);
      }
      return energy;
    });
  });
}

}  // namespace lacuna

#endif  // LACUNA_FEM_POINT_INTEGRALS_H_
