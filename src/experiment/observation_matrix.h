// Linear observations of the positions of a model's nodes.
#ifndef LACUNA_EXPERIMENT_OBSERVATION_MATRIX_H_
#define LACUNA_EXPERIMENT_OBSERVATION_MATRIX_H_

#include <Eigen/Core>
#include <vector>

namespace lacuna {

// The observation matrix W, in compressed rows: y = W x for node positions x (3n) or their Jacobian
// (3n × k).
struct ObservationMatrix {
  std::vector<int> begin{0};   // for each row, index of its first entry; rows + 1 entries
  std::vector<int> column;     // for each entry, 0 to 3n − 1
  std::vector<double> weight;  // ∂y/∂x

  int Count() const { return static_cast<int>(begin.size()) - 1; }
  Eigen::MatrixXd operator*(const Eigen::Ref<const Eigen::MatrixXd>& nodal) const;
};

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_OBSERVATION_MATRIX_H_
