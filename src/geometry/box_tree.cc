#include "geometry/box_tree.h"

#include <algorithm>

namespace lacuna {
namespace {

constexpr int kBoxesPerLeaf = 4;

}  // namespace

BoxTree::BoxTree(const std::vector<Eigen::AlignedBox3d>& boxes) {
  leaves_.reserve(boxes.size());
  for (size_t i = 0; i < boxes.size(); ++i)
    if (!boxes[i].isEmpty()) leaves_.push_back({boxes[i], static_cast<int>(i)});
  nodes_.reserve(leaves_.size());
  if (!leaves_.empty()) Build(0, static_cast<int>(leaves_.size()));
}

void BoxTree::Build(int begin, int end) {
  Eigen::AlignedBox3d all, centres;
  for (int i = begin; i < end; ++i) {
    all.extend(leaves_[i].box);
    centres.extend(leaves_[i].box.center());
  }
  const int self = static_cast<int>(nodes_.size());
  nodes_.push_back({all});
  if (end - begin <= kBoxesPerLeaf) {
    nodes_[self].begin = begin;
    nodes_[self].count = end - begin;
    return;
  }
  Eigen::Index axis = 0;
  centres.sizes().maxCoeff(&axis);
  const int middle = begin + (end - begin) / 2;
  std::nth_element(leaves_.begin() + begin, leaves_.begin() + middle, leaves_.begin() + end,
                   [axis](const Leaf& a, const Leaf& b) {
                     const double place_a = a.box.min()[axis] + a.box.max()[axis];
                     const double place_b = b.box.min()[axis] + b.box.max()[axis];
                     return place_a != place_b ? place_a < place_b : a.index < b.index;
                   });
  Build(begin, middle);
  nodes_[self].right = static_cast<int>(nodes_.size());
  Build(middle, end);
}

}  // namespace lacuna
