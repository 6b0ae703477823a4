#include <glog/logging.h>

#include <cmath>
#include <nanoflann.hpp>
#include <vector>

#include "core/parallel.h"
#include "geometry/nearest.h"

namespace lacuna {
namespace {

// The columns of a matrix as a nanoflann data set.
struct Columns {
  Eigen::Matrix3Xd points;

  size_t kdtree_get_point_count() const { return points.cols(); }
  double kdtree_get_pt(size_t column, size_t row) const { return points(row, column); }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using KdTree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Columns>,
                                                   Columns, 3, int>;
constexpr int kLeafSize = 10;
constexpr int kBlock = 256;

}  // namespace

struct PointSearch::Tree {
  explicit Tree(const Eigen::Matrix3Xd& points)
      : columns{points}, index(3, columns, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafSize)) {}
  Columns columns;
  KdTree index;
};

PointSearch::PointSearch(const Eigen::Matrix3Xd& points) {
  CHECK_GT(points.cols(), 0) << "there is no nearest point among none";
  tree_ = std::make_unique<Tree>(points);
}
PointSearch::~PointSearch() = default;
PointSearch::PointSearch(PointSearch&&) noexcept = default;
PointSearch& PointSearch::operator=(PointSearch&&) noexcept = default;

PointHits PointSearch::Nearest(const Eigen::Matrix3Xd& queries, int k) const {
  CHECK(k >= 1 && k <= tree_->columns.points.cols()) << "k = " << k;
  PointHits hits{Eigen::MatrixXi(k, queries.cols()), Eigen::MatrixXd(k, queries.cols())};
  ParallelFor(queries.cols(), kBlock, [&](int64_t i) {
    nanoflann::KNNResultSet<double, int> found(k);
    found.init(hits.index.col(i).data(), hits.distance.col(i).data());
    tree_->index.findNeighbors(found, queries.col(i).data(), {});
    hits.distance.col(i) = hits.distance.col(i).cwiseSqrt();
  });
  return hits;
}

}  // namespace lacuna
