#include "registration/block_tree.h"

#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>

#include "core/parallel.h"

namespace lacuna {
namespace {

struct Entry {
  std::array<float, 3> at;
  int point;
};

// The number of points in the first half: a power of two of leaves, so that the nodes of the tree
// coincide with the cells of the halving.
int64_t Middle(int64_t count) {
  int64_t left = kLeaf;
  while (2 * left < count) left *= 2;
  return left;
}

void Halve(Entry* begin, Entry* end, int depth, std::vector<std::pair<Entry*, Entry*>>* rest) {
  if (end - begin <= kLeaf) return;
  if (depth == 0) {
    rest->emplace_back(begin, end);
    return;
  }
  std::array<float, 3> low = begin->at, high = begin->at;
  for (const Entry* e = begin; e != end; ++e) {
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], e->at[i]);
      high[i] = std::max(high[i], e->at[i]);
    }
  }
  int axis = 0;
  for (int i = 1; i < 3; ++i) {
    if (high[i] - low[i] > high[axis] - low[axis]) axis = i;
  }
  Entry* middle = begin + Middle(end - begin);
  std::nth_element(begin, middle, end, [axis](const Entry& a, const Entry& b) {
    return a.at[axis] < b.at[axis] || (a.at[axis] == b.at[axis] && a.point < b.point);
  });
  Halve(begin, middle, depth - 1, rest);
  Halve(middle, end, depth - 1, rest);
}

typedef float Quad __attribute__((vector_size(16), may_alias));

float SquaredGap(const Box& a, const Box& b) {
  const Quad below = *reinterpret_cast<const Quad*>(a.low) - *reinterpret_cast<const Quad*>(b.high);
  const Quad above = *reinterpret_cast<const Quad*>(b.low) - *reinterpret_cast<const Quad*>(a.high);
  const Quad either = below > above ? below : above;
  const Quad gap = either > 0.f ? either : Quad{};
  const Quad squared = gap * gap;
  return squared[0] + squared[1] + squared[2];
}

}  // namespace

std::vector<int> SpatialOrder(const Eigen::Matrix3Xf& points) {
  std::vector<Entry> entries(points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    entries[i] = {{points(0, i), points(1, i), points(2, i)}, static_cast<int>(i)};
  }
  constexpr int kSerialDepth = 3;
  std::vector<std::pair<Entry*, Entry*>> parts;
  Halve(entries.data(), entries.data() + entries.size(), kSerialDepth, &parts);
  ParallelFor(parts.size(), 1, [&](int64_t k) {
    constexpr int kToTheEnd = 64;
    Halve(parts[k].first, parts[k].second, kToTheEnd, nullptr);
  });
  std::vector<int> order(entries.size());
  std::transform(entries.begin(), entries.end(), order.begin(),
                 [](const Entry& e) { return e.point; });
  return order;
}

void Box::Extend(const Box& other) {
  for (int i = 0; i < 3; ++i) {
    low[i] = std::min(low[i], other.low[i]);
    high[i] = std::max(high[i], other.high[i]);
  }
}

void Box::Extend(float x, float y, float z) { Extend(Box{{x, y, z, 0.f}, {x, y, z, 0.f}}); }

BlockTree::BlockTree(const Eigen::Matrix3Xf& points) : size_(static_cast<int>(points.cols())) {
  const int blocks = (size_ + kQueryBlock - 1) / kQueryBlock;
  queries_.resize(blocks);
  candidates_.resize(blocks * kQueryBlock);
  for (int i = size_; i < blocks * kQueryBlock; ++i) {
    QueryBlock& block = queries_[i / kQueryBlock];
    block.x[i % kQueryBlock] = block.y[i % kQueryBlock] = block.z[i % kQueryBlock] = kFarAway;
  }
  int count = (size_ + kLeaf - 1) / kLeaf;
  boxes_.emplace_back(count);
  while (count > 1) {
    count = (count + kFanOut - 1) / kFanOut;
    boxes_.emplace_back(count);
  }
  Move(points);
}

void BlockTree::Move(const Eigen::Matrix3Xf& points) {
  CHECK_EQ(points.cols(), size_);
  for (int i = 0; i < size_; ++i) {
    Candidate& candidate = candidates_[i];
    QueryBlock& block = queries_[i / kQueryBlock];
    block.x[i % kQueryBlock] = candidate.x = points(0, i);
    block.y[i % kQueryBlock] = candidate.y = points(1, i);
    block.z[i % kQueryBlock] = candidate.z = points(2, i);
  }
  for (std::vector<Box>& level : boxes_) std::fill(level.begin(), level.end(), Box());
  for (int i = 0; i < size_; ++i) {
    boxes_[0][i / kLeaf].Extend(points(0, i), points(1, i), points(2, i));
  }
  for (size_t level = 1; level < boxes_.size(); ++level) {
    for (size_t k = 0; k < boxes_[level - 1].size(); ++k) {
      boxes_[level][k / kFanOut].Extend(boxes_[level - 1][k]);
    }
  }
}

Box BlockTree::QueryBox(int block) const {
  constexpr int kLeaves = kQueryBlock / kLeaf;
  Box box;
  const int end = std::min<int>((block + 1) * kLeaves, boxes_[0].size());
  for (int leaf = block * kLeaves; leaf < end; ++leaf) box.Extend(boxes_[0][leaf]);
  return box;
}

void BlockTree::LeavesWithin(const Box& box, float radius, std::vector<int>* leaves) const {
  leaves->clear();
  if (size_ == 0) return;
  const int root = static_cast<int>(boxes_.size()) - 1;
  if (root > 0) {
    VisitChildren(root, 0, box, radius * radius, leaves);
  } else if (SquaredGap(boxes_[0][0], box) <= radius * radius) {
    leaves->push_back(0);
  }
}

void BlockTree::VisitChildren(int level, int node, const Box& box, float squared_radius,
                              std::vector<int>* leaves) const {
  const std::vector<Box>& below = boxes_[level - 1];
  const int end = std::min<int>((node + 1) * kFanOut, below.size());
  for (int child = node * kFanOut; child < end; ++child) {
    if (SquaredGap(below[child], box) > squared_radius) continue;
    if (level == 1) {
      leaves->push_back(child);
    } else {
      VisitChildren(level - 1, child, box, squared_radius, leaves);
    }
  }
}

}  // namespace lacuna
