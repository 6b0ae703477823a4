#include "fem/held_components.h"

#include <glog/logging.h>

#include <algorithm>
#include <utility>

namespace lacuna {

HeldComponents::HeldComponents(std::vector<AxisSet> axes) : axes_(std::move(axes)) {
  whole_.reserve(axes_.size());
  for (size_t i = 0; i < axes_.size(); ++i) {
    whole_.push_back(axes_[i].IsAll());
    if (!axes_[i].IsEmpty()) held_.push_back(static_cast<int>(i));
    if (axes_[i].IsPartial()) part_.push_back(static_cast<int>(i));
  }
}

bool HeldComponents::HoldsAll() const {
  return std::all_of(whole_.begin(), whole_.end(), [](char is) { return is != 0; });
}

void HeldComponents::ClearIn(Eigen::Ref<Eigen::MatrixXd> nodal) const {
  for (const int node : held_)
    for (int axis = 0; axis < 3; ++axis)
      if (axes_[static_cast<size_t>(node)].Has(axis)) nodal.row(3 * node + axis).setZero();
}

void HeldComponents::Copy(const Eigen::VectorXd& from, Eigen::VectorXd* to) const {
  for (const int node : held_)
    for (int axis = 0; axis < 3; ++axis)
      if (axes_[static_cast<size_t>(node)].Has(axis))
        (*to)[3 * node + axis] = from[3 * node + axis];
}

const BlockMatrix& HeldComponents::Decoupled(const BlockMatrix& matrix) {
  if (part_.empty()) return matrix;
  const BlockPattern& pattern = matrix.pattern();
  CHECK_EQ(axes_.size(), static_cast<size_t>(pattern.nodes));
  decoupled_ = matrix;
  for (const int node : part_) {
    const int diagonal = pattern.diagonal[static_cast<size_t>(node)];
    const double size = matrix.Block(diagonal).diagonal().cwiseAbs().maxCoeff();
    for (int axis = 0; axis < 3; ++axis) {
      if (!axes_[static_cast<size_t>(node)].Has(axis)) continue;
      for (int k = pattern.row_begin[static_cast<size_t>(node)];
           k < pattern.row_begin[static_cast<size_t>(node) + 1]; ++k) {
        decoupled_->Block(k).row(axis).setZero();
        decoupled_->Block(pattern.Find(pattern.column[static_cast<size_t>(k)], node))
            .col(axis)
            .setZero();
      }
      decoupled_->Block(diagonal)(axis, axis) = size > 0 ? size : 1;
    }
  }
  return *decoupled_;
}

}  // namespace lacuna
