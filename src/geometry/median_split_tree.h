// A bounding volume hierarchy with median splits.
#ifndef LACUNA_GEOMETRY_MEDIAN_SPLIT_TREE_H_
#define LACUNA_GEOMETRY_MEDIAN_SPLIT_TREE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <utility>
#include <vector>

namespace lacuna {

// A balanced binary tree over items in space, each of which has
//   int index;                              different for each item
//   Eigen::AlignedBox3d Box() const;        around the item
//   double Place(Eigen::Index axis) const;  a coordinate of a point that represents it, any scale
// Each inner node divides its items in halves by their places along the axis of the largest extent
// of these, equal ones by their indices. Building takes O(n log² n); the tree depends only on the
// items and their order, and has fewer than 64 levels.
template <typename Item>
class MedianSplitTree {
 public:
  struct Node {
    Eigen::AlignedBox3d box;
    int right = 0;  // inner node: the right child; the left one follows its parent
    int begin = 0;  // leaf: its first item
    int count = 0;  // leaf: the number of its items, > 0
  };

  explicit MedianSplitTree(std::vector<Item> items) : items_(std::move(items)) {
    nodes_.reserve(items_.size());
    if (!items_.empty()) Build(0, static_cast<int>(items_.size()));
  }

  // In depth-first order from the root; empty without items.
  const std::vector<Node>& nodes() const { return nodes_; }
  // In the order of the leaves.
  const std::vector<Item>& items() const { return items_; }

 private:
  static constexpr int kItemsPerLeaf = 4;

  void Build(int begin, int end) {
    Eigen::AlignedBox3d box, places;
    for (int i = begin; i < end; ++i) {
      const Item& item = items_[i];
      box.extend(item.Box());
      places.extend(Eigen::Vector3d(item.Place(0), item.Place(1), item.Place(2)));
    }
    const int self = static_cast<int>(nodes_.size());
    nodes_.push_back({box});
    if (end - begin <= kItemsPerLeaf) {
      nodes_[self].begin = begin;
      nodes_[self].count = end - begin;
      return;
    }
    Eigen::Index axis = 0;
    places.sizes().maxCoeff(&axis);
    const int middle = begin + (end - begin) / 2;
    std::nth_element(items_.begin() + begin, items_.begin() + middle, items_.begin() + end,
                     [axis](const Item& a, const Item& b) {
                       const double place_a = a.Place(axis), place_b = b.Place(axis);
                       return place_a != place_b ? place_a < place_b : a.index < b.index;
                     });
    Build(begin, middle);
    nodes_[self].right = static_cast<int>(nodes_.size());
    Build(middle, end);
  }

  std::vector<Item> items_;
  std::vector<Node> nodes_;
};

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_MEDIAN_SPLIT_TREE_H_
