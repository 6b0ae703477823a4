#include "scan/surface_scatter.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/median.h"
#include "core/parallel.h"
#include "core/random_bits.h"
#include "geometry/nearest.h"

namespace lacuna {
namespace {

constexpr double kUndetermined = std::numeric_limits<double>::quiet_NaN();
constexpr double kDeviationsOfMedian = 1.4826;  // 1/Φ⁻¹(3/4)
constexpr int kCoefficients = 6;                // of a quadric
// Neighbourhoods. Smaller: less of the shape is mistaken for scatter; larger: neighbourhoods of
// clouds that scatter by more than their spacing remain flat.
constexpr int kFew = 12, kMany = 24;
constexpr int kExamined = 2000;  // points of a cloud; the median is then known to some 3 %
// Below this number the median is not known to a third.
constexpr size_t kFewestExamined = 20;
// Scatter of equal size in both neighbourhoods differs by less, and unresolved shape, which grows
// with the third power of the width, by a factor of 2.8.
constexpr double kShapeRatio = 1.5;
// A cloud that scatters by more than this multiple of its spacing fills the smaller neighbourhood
// evenly, which then shows too little of the scatter.
constexpr double kThick = 0.3;
// The neighbours lie along a line if their variance across it is less than this share of that along
// it: no surface passes through them.
constexpr double kLine = 0.05;
constexpr double kOutlier = 5;            // standard deviations
constexpr double kHarmlessSpacing = 0.1;  // of the spacing, counts as scatter for outliers

// A point beside the surface through its neighbours.
struct Offset {
  double distance = kUndetermined;  // m; NaN where the neighbours do not determine a surface
  double factor = 1;                // √(1 + g)
  double neighbours = 0;            // m, σ of the neighbours about the same surface
};

template <int kCount>
Offset OffsetFrom(const Eigen::Vector3d& point, const Eigen::Matrix<double, 3, kCount>& near) {
  const Eigen::Matrix<double, 3, kCount> centred = near.colwise() - near.rowwise().mean().eval();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(centred * centred.transpose());
  if (!(axes.eigenvalues()[1] > kLine * axes.eigenvalues()[2])) return {};
  Eigen::Matrix<double, 3, kCount> local =
      axes.eigenvectors().transpose() * (near.colwise() - point);
  const double width = local.colwise().norm().maxCoeff();
  local /= width;
  const Eigen::Array<double, kCount, 1> u = local.row(2), v = local.row(1);
  Eigen::Matrix<double, kCount, kCoefficients> x;
  x << Eigen::Matrix<double, kCount, 1>::Ones(), u, v, u.square(), u * v, v.square();
  const Eigen::LDLT<Eigen::Matrix<double, kCoefficients, kCoefficients>> normal(x.transpose() * x);
  constexpr double kSingular = 1e-6;  // smallest pivot; the largest is the number of points
  if (!(normal.vectorD().minCoeff() > kSingular)) return {};
  const Eigen::Matrix<double, kCount, 1> height = local.row(0);
  const Eigen::Matrix<double, kCoefficients, 1> quadric = normal.solve(x.transpose() * height);
  using Coefficients = Eigen::Matrix<double, kCoefficients, 1>;
  const double g = normal.solve(Coefficients::Unit(0))[0];
  const Eigen::Matrix<double, kCount, 1> rest = (height - x * quadric).cwiseAbs();
  const double freedom = static_cast<double>(kCount - kCoefficients) / kCount;
  return {width * std::abs(quadric[0]), std::sqrt(1 + g),
          width * kDeviationsOfMedian * Median({rest.begin(), rest.end()}) / std::sqrt(freedom)};
}

// The points that are examined: one of each block of consecutive points. Which one is drawn at
// random, because every hundredth point of an image may lie in the same column.
std::vector<Eigen::Index> Examined(Eigen::Index count, Eigen::Index most) {
  const Eigen::Index blocks = std::min(count, most);
  std::vector<Eigen::Index> chosen;
  for (Eigen::Index b = 0; b < blocks; ++b) {
    const Eigen::Index begin = b * count / blocks, end = (b + 1) * count / blocks;
    const uint64_t bits = RandomBits({static_cast<uint64_t>(b)});
    chosen.push_back(begin + static_cast<Eigen::Index>(bits % static_cast<uint64_t>(end - begin)));
  }
  return chosen;
}

struct Offsets {
  std::vector<Offset> few, many;
  std::vector<double> spacings;  // m
};

// Adds the offsets of some points of one view, which `share` of all examined points belong to.
void Examine(const Eigen::Matrix3Xd& points, double share, Offsets* all) {
  if (points.cols() < kMany + 1) return;
  const auto most = std::max<Eigen::Index>(1, std::llround(share * kExamined));
  const std::vector<Eigen::Index> chosen = Examined(points.cols(), most);
  const PointHits hits = PointSearch(points).Nearest(points(Eigen::all, chosen), kMany + 1);
  const size_t count = chosen.size(), before = all->few.size();
  all->few.resize(before + count);
  all->many.resize(before + count);
  all->spacings.resize(before + count);
  constexpr int kBlock = 64;
  ParallelFor(static_cast<int64_t>(count), kBlock, [&](int64_t k) {
    // The point is one of its own neighbours, but not the first where another has the same place.
    Eigen::Matrix<double, 3, kMany> near;
    int found = 0;
    for (int j = 0; j <= kMany && found < kMany; ++j) {
      if (hits.index(j, k) != chosen[k]) near.col(found++) = points.col(hits.index(j, k));
    }
    const Eigen::Vector3d point = points.col(chosen[k]);
    all->many[before + k] = OffsetFrom<kMany>(point, near);
    all->few[before + k] = OffsetFrom<kFew>(point, near.leftCols<kFew>());
    // A disc with the k-th neighbour on its edge has the area of about k points.
    all->spacings[before + k] = hits.distance(kFew, k) * std::sqrt(std::numbers::pi / kFew);
  });
}

// NaN where less than half of the points have an offset.
double DeviationOf(const std::vector<Offset>& offsets) {
  std::vector<double> known;
  for (const Offset& offset : offsets) {
    if (!std::isnan(offset.distance)) known.push_back(offset.distance / offset.factor);
  }
  if (known.size() < kFewestExamined || 2 * known.size() < offsets.size()) return kUndetermined;
  return kDeviationsOfMedian * Median(std::move(known));
}

void CountOutliers(const std::vector<Offset>& offsets, SurfaceScatter* scatter) {
  const double least = std::max(scatter->deviation, kHarmlessSpacing * scatter->spacing);
  double known = 0, outliers = 0;
  for (const Offset& offset : offsets) {
    if (std::isnan(offset.distance)) continue;
    ++known;
    if (offset.distance <= kOutlier * offset.factor * std::max(least, offset.neighbours)) continue;
    ++outliers;
    scatter->farthest = std::max(scatter->farthest, offset.distance);
  }
  if (known > 0) scatter->outlier_share = outliers / known;
}

}  // namespace

SurfaceScatter MeasureSurfaceScatter(const Eigen::Matrix3Xd& points,
                                     const Eigen::VectorXi& seen_by) {
  Offsets offsets;
  const int views = seen_by.size() == 0 ? 1 : seen_by.maxCoeff() + 1;
  for (int view = 0; view < views; ++view) {
    std::vector<Eigen::Index> own;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      if (seen_by.size() == 0 || seen_by[i] == view) own.push_back(i);
    }
    Examine(points(Eigen::all, own),
            static_cast<double>(own.size()) / static_cast<double>(points.cols()), &offsets);
  }
  SurfaceScatter scatter;
  if (offsets.few.size() < kFewestExamined) return scatter;
  scatter.spacing = Median(offsets.spacings);
  const double few = DeviationOf(offsets.few), many = DeviationOf(offsets.many);
  if (std::isnan(many)) return scatter;
  const bool is_thick = many > kThick * scatter.spacing;
  scatter.deviation = is_thick ? many : std::fmin(few, many);
  scatter.is_upper_bound = !is_thick && !(many <= kShapeRatio * few);
  CountOutliers(offsets.many, &scatter);
  return scatter;
}

}  // namespace lacuna
