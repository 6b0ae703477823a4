// The components of nodal vectors that are prescribed: those of nodes that are held along some or
// all coordinate axes.
//
// A node that is held along all axes is left out of a linear system (elimination_order.h). Of a
// node that is held along some axes, as on a plane of symmetry, the system keeps all three
// equations; those of the held components are replaced by d u = 0, with a positive d of the size of
// the other diagonal entries, and their coefficients in the other equations by 0. The matrix stays
// symmetric, and definite on the free components if it was before.
#ifndef LACUNA_FEM_HELD_COMPONENTS_H_
#define LACUNA_FEM_HELD_COMPONENTS_H_

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fem/block_matrix.h"
#include "geometry/axis_set.h"

namespace lacuna {

class HeldComponents {
 public:
  explicit HeldComponents(std::vector<AxisSet> axes);  // one set per node

  const std::vector<AxisSet>& axes() const { return axes_; }
  // One flag per node: 1 where all components are held.
  const std::vector<char>& whole_nodes() const { return whole_; }
  bool HoldsPart(int node) const { return axes_[static_cast<size_t>(node)].IsPartial(); }
  bool HoldsAll() const;  // whether no component is free

  // Sets the held components of nodal vectors (3n × k) to 0.
  void ClearIn(Eigen::Ref<Eigen::MatrixXd> nodal) const;
  // Sets the held components of `to` (3n) to those of `from`.
  void Copy(const Eigen::VectorXd& from, Eigen::VectorXd* to) const;

  // The matrix in which the held components of nodes that are held in part are decoupled, as
  // described above. If there are none this is `matrix` itself; otherwise it is a copy that is
  // valid until the next call, which changes it.
  const BlockMatrix& Decoupled(const BlockMatrix& matrix);

 private:
  std::vector<AxisSet> axes_;
  std::vector<char> whole_;
  std::vector<int> held_;  // nodes that are held along any axis, ascending
  std::vector<int> part_;  // nodes that are held along some but not all axes
  std::optional<BlockMatrix> decoupled_;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_HELD_COMPONENTS_H_
