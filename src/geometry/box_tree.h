// A search for the axis-aligned boxes that contain a point.
#ifndef LACUNA_GEOMETRY_BOX_TREE_H_
#define LACUNA_GEOMETRY_BOX_TREE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "geometry/median_split_tree.h"

namespace lacuna {

// A hierarchy of boxes: finding the k boxes around a point takes about O(k + log n), however
// different the sizes of the boxes are. It may be queried from several threads.
class BoxTree {
 public:
  // An empty box contains no point.
  explicit BoxTree(const std::vector<Eigen::AlignedBox3d>& boxes);

  // Calls visit(i) once for each box i that contains `point`, its sides included, in an order that
  // depends on the boxes only.
  template <typename Visit>
  void ForEachAround(const Eigen::Vector3d& point, const Visit& visit) const {
    if (tree_.nodes().empty()) return;
    std::array<int, 64> pending;  // one for each level of a balanced tree
    int depth = 0;
    pending[depth++] = 0;
    while (depth > 0) {
      const int at = pending[--depth];
      const auto& node = tree_.nodes()[at];
      if (!node.box.contains(point)) continue;
      for (int i = node.begin; i < node.begin + node.count; ++i)
        if (tree_.items()[i].box.contains(point)) visit(tree_.items()[i].index);
      if (node.count > 0) continue;
      pending[depth++] = node.right;
      pending[depth++] = at + 1;
    }
  }

 private:
  struct Leaf {
    Eigen::AlignedBox3d box;
    int index;  // among the boxes of the constructor
    const Eigen::AlignedBox3d& Box() const { return box; }
    double Place(Eigen::Index axis) const { return box.min()[axis] + box.max()[axis]; }
  };
  static std::vector<Leaf> LeavesOf(const std::vector<Eigen::AlignedBox3d>& boxes);

  MedianSplitTree<Leaf> tree_;
};

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_BOX_TREE_H_
