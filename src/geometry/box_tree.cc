#include "geometry/box_tree.h"

namespace lacuna {

BoxTree::BoxTree(const std::vector<Eigen::AlignedBox3d>& boxes) : tree_(LeavesOf(boxes)) {}

std::vector<BoxTree::Leaf> BoxTree::LeavesOf(const std::vector<Eigen::AlignedBox3d>& boxes) {
  std::vector<Leaf> leaves;
  leaves.reserve(boxes.size());
  for (size_t i = 0; i < boxes.size(); ++i)
    if (!boxes[i].isEmpty()) leaves.push_back({boxes[i], static_cast<int>(i)});
  return leaves;
}

}  // namespace lacuna
