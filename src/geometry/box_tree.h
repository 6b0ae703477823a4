// A search for the axis-aligned boxes that contain a point.
#ifndef LACUNA_GEOMETRY_BOX_TREE_H_
#define LACUNA_GEOMETRY_BOX_TREE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

namespace lacuna {

// A bounding volume hierarchy with median splits: building takes O(n log² n) and finding the k
// boxes around a point about O(k + log n), however different the sizes of the boxes are. It may be
// queried from several threads.
class BoxTree {
 public:
  // An empty box contains no point.
  explicit BoxTree(const std::vector<Eigen::AlignedBox3d>& boxes);

  // Calls visit(i) once for each box i that contains `point`, its sides included, in an order that
  // depends on the boxes only.
  template <typename Visit>
  void ForEachAround(const Eigen::Vector3d& point, const Visit& visit) const {
    if (nodes_.empty()) return;
    std::array<int, 64> pending;  // one for each level of a balanced tree
    int depth = 0;
    pending[depth++] = 0;
    while (depth > 0) {
      const int at = pending[--depth];
      const Node& node = nodes_[at];
      if (!node.box.contains(point)) continue;
      for (int i = node.begin; i < node.begin + node.count; ++i)
        if (leaves_[i].box.contains(point)) visit(leaves_[i].index);
      if (node.count > 0) continue;
      pending[depth++] = node.right;
      pending[depth++] = at + 1;
    }
  }

 private:
  // Nodes are stored in depth-first order, so the left child follows its parent.
  struct Node {
    Eigen::AlignedBox3d box;
    int right = 0;  // inner node: the right child
    int begin = 0;  // leaf: its boxes
    int count = 0;  // leaf: > 0
  };
  struct Leaf {
    Eigen::AlignedBox3d box;
    int index;  // among the boxes of the constructor
  };
  void Build(int begin, int end);

  std::vector<Leaf> leaves_;
  std::vector<Node> nodes_;
};

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_BOX_TREE_H_
