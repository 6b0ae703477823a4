// Points in an order in which neighbours in space are neighbours in memory, and boxes over runs of
// them: what the truncated Gaussian sums walk over. Memory is linear in the number of points.
#ifndef LACUNA_REGISTRATION_BLOCK_TREE_H_
#define LACUNA_REGISTRATION_BLOCK_TREE_H_

#include <Eigen/Core>
#include <vector>

#include "registration/gaussian_sums.h"

namespace lacuna {

// A permutation of the points (3 × n, finite) by repeated halving along the widest side, such that
// every aligned run of 8·2^k points fills a compact box. `order[i]` is the point that comes i-th.
std::vector<int> SpatialOrder(const Eigen::Matrix3Xf& points);

// The fourth component is idle: it makes a box two SIMD registers of every x86-64 processor.
struct alignas(16) Box {
  float low[4] = {kFarAway, kFarAway, kFarAway, 0.f};
  float high[4] = {-kFarAway, -kFarAway, -kFarAway, 0.f};

  void Extend(const Box& other);
  void Extend(float x, float y, float z);
};

// A cloud in both roles of the Gaussian sums. The points come in spatial order and may be moved;
// the order, and with it the tree, stays that of the beginning.
class BlockTree {
 public:
  explicit BlockTree(const Eigen::Matrix3Xf& points);

  // New positions (3 × n), the same number. Keeps the weights.
  void Move(const Eigen::Matrix3Xf& points);
  void SetWeight(int point, float weight) { candidates_[point].weight = weight; }

  int Size() const { return size_; }
  int QueryBlockCount() const { return static_cast<int>(queries_.size()); }
  const QueryBlock& Queries(int block) const { return queries_[block]; }
  Box QueryBox(int block) const;
  const Candidate* Candidates() const { return candidates_.data(); }

  // The leaves whose boxes come within `radius` of `box`, ascending.
  void LeavesWithin(const Box& box, float radius, std::vector<int>* leaves) const;

 private:
  static constexpr int kFanOut = 4;

  void VisitChildren(int level, int node, const Box& box, float squared_radius,
                     std::vector<int>* leaves) const;

  int size_ = 0;
  std::vector<QueryBlock> queries_;      // padded with points far away
  std::vector<Candidate> candidates_;    // padded with points far away, weight 0
  std::vector<std::vector<Box>> boxes_;  // [0]: of the leaves; [k]: of kFanOut boxes of [k − 1]
};

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_BLOCK_TREE_H_
