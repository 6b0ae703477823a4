#include "experiment/surface_observer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/median.h"
#include "experiment/scan_matches.h"

namespace lacuna {
namespace {

constexpr double kOutlier = 4;    // standard deviations from a patch's median
constexpr int kFewestPoints = 3;  // fewest points with which a patch counts as seen

// The entries of `points` whose errors are not outliers, in the same order.
std::vector<int> Agreeing(const std::vector<ScanMatch>& matches, const std::vector<int>& points,
                          double noise) {
  std::vector<double> errors;
  for (const int j : points) errors.push_back(matches[j].error);
  const double median = Median(errors);
  for (double& error : errors) error = std::abs(error - median);
  constexpr double kDeviationOfMedian = 1.4826;  // σ over median deviation, normal distribution
  const double widest = kOutlier * std::max(noise, kDeviationOfMedian * Median(errors));
  std::vector<int> kept;
  for (const int j : points)
    if (std::abs(matches[j].error - median) <= widest) kept.push_back(j);
  return kept;
}

// Accumulates a sparse row of weights. Clearing it takes time proportional to its entries.
class RowSum {
 public:
  explicit RowSum(Eigen::Index columns) : sum_(columns, 0.0), is_there_(columns, 0) {}
  void Add(int column, double weight) {
    if (!is_there_[column]) touched_.push_back(column);
    is_there_[column] = 1;
    sum_[column] += weight;
  }
  // Appends the row, divided by `count`, with ascending columns, and clears it.
  void Flush(double count, ObservationMatrix* rows) {
    std::sort(touched_.begin(), touched_.end());
    for (const int column : touched_) {
      rows->column.push_back(column);
      rows->weight.push_back(sum_[column] / count);
      sum_[column] = 0;
      is_there_[column] = 0;
    }
    rows->begin.push_back(static_cast<int>(rows->column.size()));
    touched_.clear();
  }

 private:
  std::vector<double> sum_;
  std::vector<char> is_there_;
  std::vector<int> touched_;
};

}  // namespace

SurfaceObserver::SurfaceObserver(std::shared_ptr<const ScanFrames> scans,
                                 std::shared_ptr<const Body> body, const SurfacePatches& patches,
                                 const ScanSettings& settings)
    : scans_(std::move(scans)),
      body_(std::move(body)),
      patches_(patches),
      reach_(settings.reach * BoundingBoxDiagonal(body_->mesh.nodes)) {
  const ReferenceShape& reference = scans_->recording().reference;
  if (reference.sheet_face == SheetFace::kMiddle) depth_ = 0.5 * reference.sheet_thickness;
}

Observed SurfaceObserver::ObserveWithin(double reach_factor, int frame,
                                        const Eigen::VectorXd& position) const {
  const ScannedPoints& scan = scans_->At(frame);
  const BoundarySurface& boundary = body_->boundary;
  const Eigen::Map<const Eigen::Matrix3Xd> nodes(position.data(), 3, position.size() / 3);
  const ScanMatches found = MatchScan(scan, *body_, patches_, nodes, reach_factor * reach_, depth_);
  const std::vector<ScanMatch>& matches = found.matches;

  const int patches = PointCount();
  std::vector<std::vector<int>> members(static_cast<size_t>(patches));
  for (size_t j = 0; j < matches.size(); ++j)
    if (matches[j].patch >= 0) members[matches[j].patch].push_back(static_cast<int>(j));

  Observed observed;
  observed.offered = static_cast<int>(matches.size());
  observed.distance = found.distance;
  observed.target = Eigen::VectorXd::Zero(patches);
  observed.count = Eigen::VectorXd::Zero(patches);
  observed.normal = patches_.normal;
  observed.measured =
      Eigen::Matrix3Xd::Constant(3, patches, std::numeric_limits<double>::quiet_NaN());
  ObservationMatrix rows;
  RowSum sum(position.size());
  for (int c = 0; c < patches; ++c) {
    std::vector<int> points;
    if (members[c].size() >= kFewestPoints) points = Agreeing(matches, members[c], scan.noise);
    const int count = static_cast<int>(points.size());
    if (count < kFewestPoints) {
      rows.begin.push_back(static_cast<int>(rows.column.size()));
      continue;
    }
    Eigen::Vector3d place = Eigen::Vector3d::Zero(), normal = place;
    for (const int j : points) {
      const ScanMatch& match = matches[j];
      for (int a = 0; a < match.place.count; ++a) {
        const int node = boundary.faces(a, match.place.face);
        for (int axis = 0; axis < 3; ++axis)
          sum.Add(3 * node + axis, match.place.weight[a] * match.normal[axis]);
      }
      observed.target[c] += match.normal.dot(scan.cloud.points.col(j)) + match.depth;
      place += scan.cloud.points.col(j);
      normal += match.normal;
    }
    sum.Flush(count, &rows);
    observed.target[c] /= count;
    observed.count[c] = count;
    observed.used += count;
    observed.measured.col(c) = place / count;
    observed.normal.col(c) = normal.normalized();
  }
  observed.rows = std::make_shared<const ObservationMatrix>(std::move(rows));
  return observed;
}

}  // namespace lacuna
