#include "fem/element_kinematics.h"

#include "fem/target_clones.h"

namespace lacuna {
namespace {

// Inlined into one function for each instruction set.
template <int kNodes>
[[gnu::always_inline]] inline void Gradients(const double* field, const int* node,
                                             const double* shape_gradient, double* gradient) {
  Four edge[kNodes - 1], first;
  LoadFour<3>(field + 3 * node[0], &first);
  for (int a = 1; a < kNodes; ++a) {
    LoadFour<3>(field + 3 * node[a], &edge[a - 1]);
    edge[a - 1] -= first;
  }
  for (int column = 0; column < 3 * QuadraturePoints<kNodes>(); ++column) {
    const double* g = shape_gradient + kNodes * column + 1;
    Four sum = edge[0] * g[0];
    for (int a = 1; a < kNodes - 1; ++a) sum += edge[a] * g[a];
    for (int i = 0; i < 3; ++i) gradient[3 * column + i] = sum[i];
  }
}

template <int kNodes>
[[gnu::always_inline]] inline void SubtractForces(const double* P, const int* node,
                                                  const double* shape_gradient, double* field) {
  Four sum[kNodes] = {};
  for (int q = 0; q < QuadraturePoints<kNodes>(); ++q) {
    Four column[3];
    for (int j = 0; j < 3; ++j) LoadFour<3>(P + 9 * q + 3 * j, &column[j]);
    const double* g = shape_gradient + 3 * kNodes * q;
    for (int a = 0; a < kNodes; ++a)
      sum[a] += column[0] * g[a] + column[1] * g[kNodes + a] + column[2] * g[2 * kNodes + a];
  }
  for (int a = 0; a < kNodes; ++a)
    for (int i = 0; i < 3; ++i) field[3 * node[a] + i] -= sum[a][i];
}

}  // namespace

LACUNA_FOR_EACH_INSTRUCTION_SET
void GradientsOf4(const double* field, const int* node, const double* shape_gradient,
                  double* gradient) {
  Gradients<4>(field, node, shape_gradient, gradient);
}

LACUNA_FOR_EACH_INSTRUCTION_SET
void GradientsOf10(const double* field, const int* node, const double* shape_gradient,
                   double* gradient) {
  Gradients<10>(field, node, shape_gradient, gradient);
}

LACUNA_FOR_EACH_INSTRUCTION_SET
void SubtractForcesOf4(const double* P, const int* node, const double* shape_gradient,
                       double* field) {
  SubtractForces<4>(P, node, shape_gradient, field);
}

LACUNA_FOR_EACH_INSTRUCTION_SET
void SubtractForcesOf10(const double* P, const int* node, const double* shape_gradient,
                        double* field) {
  SubtractForces<10>(P, node, shape_gradient, field);
}

}  // namespace lacuna
