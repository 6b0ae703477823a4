// A bounding-box tree over points that are sorted so that neighbours in space are neighbours in
// memory; the truncated Gaussian sums traverse it. Memory is linear in the number of points.
#ifndef LACUNA_REGISTRATION_BLOCK_TREE_H_
#define LACUNA_REGISTRATION_BLOCK_TREE_H_

#include <Eigen/Core>
#include <vector>

#include "registration/gaussian_sums.h"

namespace lacuna {

// A permutation of the points (3 × n, finite) by repeated halving along the longest side, such that
// every aligned run of 8·2^k points fills a compact box. Entry i is the index of the i-th point.
std::vector<int> SpatialOrder(const Eigen::Matrix3Xf& points);

// An axis-aligned box, empty by default. The fourth component is unused; with it a box fits exactly
// into two SIMD registers.
struct alignas(16) Box {
  float low[4] = {kFarAway, kFarAway, kFarAway, 0.f};
  float high[4] = {-kFarAway, -kFarAway, -kFarAway, 0.f};

  void Extend(const Box& other);
  void Extend(float x, float y, float z);
};

// A cloud that can serve as queries and as candidates of the Gaussian sums. The points must be in
// spatial order. They may be moved, which keeps their order and thus the structure of the tree.
class BlockTree {
 public:
  explicit BlockTree(const Eigen::Matrix3Xf& points);

  // Sets new positions (3 × n) of the same number of points (CHECK). Keeps the weights.
  void Move(const Eigen::Matrix3Xf& points);
  void SetWeight(int point, float weight) { candidates_[point].weight = weight; }

  int Size() const { return size_; }
  int QueryBlockCount() const { return static_cast<int>(queries_.size()); }
  const QueryBlock& Queries(int block) const { return queries_[block]; }
  Box QueryBox(int block) const;
  const Candidate* Candidates() const { return candidates_.data(); }

  // Stores in `*leaves` the leaves whose boxes have a distance of at most `radius` from `box`, in
  // ascending order.
  void LeavesWithin(const Box& box, float radius, std::vector<int>* leaves) const;

 private:
  static constexpr int kFanOut = 4;

  void VisitChildren(int level, int node, const Box& box, float squared_radius,
                     std::vector<int>* leaves) const;

  int size_ = 0;
  std::vector<QueryBlock> queries_;      // padded with points at kFarAway
  std::vector<Candidate> candidates_;    // padded with points at kFarAway of weight 0
  std::vector<std::vector<Box>> boxes_;  // [0]: the leaves; [k]: unions of kFanOut boxes of [k − 1]
};

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_BLOCK_TREE_H_
