#include "scan/normal_orientation.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>
#include <tuple>
#include <vector>

#include "geometry/nearest.h"

namespace lacuna {
namespace {

constexpr int kUnreached = -1;

struct NeighbourGraph {
  std::vector<std::vector<int>> adjacent;  // symmetric
  Eigen::VectorXd radius;                  // n, distance of the furthest of the k nearest, m
  Eigen::Matrix3Xd mean;                   // 3 × n, of the k nearest
};

NeighbourGraph BuildGraph(const Eigen::Matrix3Xd& points, int neighbours) {
  const Eigen::Index count = points.cols();
  const int k = static_cast<int>(std::min<Eigen::Index>(neighbours + 1, count));
  const PointHits hits = PointSearch(points).Nearest(points, k);
  NeighbourGraph graph;
  graph.adjacent.resize(count);
  graph.radius = hits.distance.row(k - 1).transpose();
  graph.mean.resize(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    graph.mean.col(i) = points(Eigen::all, hits.index.col(i)).rowwise().mean();
    for (int j = 0; j < k; ++j) {
      const int other = hits.index(j, i);
      if (other == i) continue;
      graph.adjacent[i].push_back(other);
      graph.adjacent[other].push_back(static_cast<int>(i));
    }
  }
  for (std::vector<int>& list : graph.adjacent) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return graph;
}

// The cosine between the normal `to` and the normal `from` after it was reflected at the bisecting
// plane of the edge. On a circle the reflection takes one normal exactly into the other. The
// direction of an edge much shorter than the neighbourhood is mostly noise: there the reflection
// fades out.
double CarriedCosine(const Eigen::Vector3d& edge, double radius, const Eigen::Vector3d& from,
                     const Eigen::Vector3d& to) {
  const double damped = edge.squaredNorm() + 0.0625 * radius * radius;
  if (damped == 0) return from.dot(to);
  const Eigen::Vector3d carried = from - (2 * edge.dot(from) / damped) * edge;
  const double length = carried.norm();
  return length > 0 ? carried.dot(to) / length : 0;
}

// Propagates signs along a minimum spanning tree (Prim) of each connected part of the graph.
// Returns the number of the part of each point.
std::vector<int> Propagate(const Eigen::Matrix3Xd& points, const NeighbourGraph& graph,
                           Eigen::Matrix3Xd* normals) {
  const int count = static_cast<int>(points.cols());
  // Noise along the normal would tilt the edges, so each point is first moved to its tangent plane.
  Eigen::Matrix3Xd smooth = points;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d n = normals->col(i);
    smooth.col(i) -= (points.col(i) - graph.mean.col(i)).dot(n) * n;
  }
  std::vector<int> part(count, kUnreached);
  using Edge = std::tuple<double, int, int>;  // cost, from, to; equal costs: smaller numbers first
  std::priority_queue<Edge, std::vector<Edge>, std::greater<>> open;
  const auto reach = [&](int i, int which) {
    part[i] = which;
    for (const int j : graph.adjacent[i]) {
      if (part[j] != kUnreached) continue;
      const double radius = std::max(graph.radius[i], graph.radius[j]);
      const double cosine =
          CarriedCosine(smooth.col(j) - smooth.col(i), radius, normals->col(i), normals->col(j));
      open.emplace(1 - std::abs(cosine), i, j);
    }
  };
  int part_count = 0;
  for (int start = 0; start < count; ++start) {
    if (part[start] != kUnreached) continue;
    reach(start, part_count);
    while (!open.empty()) {
      const auto [cost, from, to] = open.top();
      open.pop();
      if (part[to] != kUnreached) continue;
      const double radius = std::max(graph.radius[from], graph.radius[to]);
      if (CarriedCosine(smooth.col(to) - smooth.col(from), radius, normals->col(from),
                        normals->col(to)) < 0) {
        normals->col(to) *= -1;
      }
      reach(to, part_count);
    }
    ++part_count;
  }
  return part;
}

// How well each part faces outward, in [−1, 1], judged by the sensor nearest to each point.
Eigen::VectorXd VoteBySensors(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& normals,
                              const Eigen::Matrix3Xd& sensors, const std::vector<int>& part,
                              int part_count) {
  Eigen::VectorXd vote = Eigen::VectorXd::Zero(part_count);
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(part_count);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    Eigen::Index nearest = 0;
    (sensors.colwise() - points.col(i)).colwise().squaredNorm().minCoeff(&nearest);
    const double cosine = (sensors.col(nearest) - points.col(i)).normalized().dot(normals.col(i));
    vote[part[i]] += cosine;
    weight[part[i]] += std::abs(cosine);
  }
  return vote.array() / weight.array().max(1e-300);
}

// The same without sensors: the outermost point in a direction should face that direction, and a
// part without outermost points should face away from the centre.
Eigen::VectorXd VoteByExtremes(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& normals,
                               const std::vector<int>& part, int part_count) {
  constexpr int kDirections = 400;
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
  Eigen::VectorXd vote = Eigen::VectorXd::Zero(part_count);
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(part_count);
  for (int d = 0; d < kDirections; ++d) {
    const double z = 1 - (2 * d + 1.0) / kDirections, r = std::sqrt(1 - z * z);
    const Eigen::Vector3d direction(r * std::cos(golden_angle * d), r * std::sin(golden_angle * d),
                                    z);
    Eigen::Index outermost = 0;
    (direction.transpose() * points).maxCoeff(&outermost);
    const double cosine = direction.dot(normals.col(outermost));
    vote[part[outermost]] += cosine;
    weight[part[outermost]] += std::abs(cosine);
  }
  const Eigen::Vector3d center = points.rowwise().mean();
  Eigen::VectorXd flux = Eigen::VectorXd::Zero(part_count), total = flux;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const double outward = (points.col(i) - center).dot(normals.col(i));
    flux[part[i]] += outward;
    total[part[i]] += std::abs(outward);
  }
  for (int p = 0; p < part_count; ++p) {
    vote[p] = weight[p] > 0 ? vote[p] / weight[p] : total[p] > 0 ? flux[p] / total[p] : 0;
  }
  return vote;
}

void FaceOwnSensor(const Eigen::Matrix3Xd& points, const Sensors& sensors,
                   const NeighbourGraph& graph, Eigen::Matrix3Xd* normals) {
  constexpr double kGrazing = 0.17;  // cosine of 80°; below, noise may flip the sign
  std::vector<int> grazing;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3d ray =
        (sensors.positions.col(sensors.seen_by[i]) - points.col(i)).normalized();
    const double cosine = ray.dot(normals->col(i));
    if (cosine < 0) normals->col(i) *= -1;
    if (std::abs(cosine) < kGrazing) grazing.push_back(static_cast<int>(i));
  }
  std::vector<bool> is_grazing(points.cols(), false);
  for (const int i : grazing) is_grazing[i] = true;
  for (const int i : grazing) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const int j : graph.adjacent[i]) {
      if (!is_grazing[j]) sum += normals->col(j);
    }
    if (sum.dot(normals->col(i)) < 0) normals->col(i) *= -1;
  }
}

// Neighbours that lie side by side and are nearly parallel must agree; points on the two sides of a
// thin sheet are behind one another and need not.
double Disagreement(const Eigen::Matrix3Xd& points, const NeighbourGraph& graph,
                    const Eigen::Matrix3Xd& normals) {
  int64_t pairs = 0, opposite = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    for (const int j : graph.adjacent[i]) {
      const double cosine = normals.col(i).dot(normals.col(j));
      const Eigen::Vector3d edge = points.col(j) - points.col(i);
      const bool beside = std::abs(edge.dot(normals.col(i))) < 0.5 * edge.norm();
      if (std::abs(cosine) < M_SQRT1_2 || !beside) continue;
      ++pairs;
      if (cosine < 0) ++opposite;
    }
  }
  return pairs > 0 ? static_cast<double>(opposite) / static_cast<double>(pairs) : 0;
}

}  // namespace

Orientation OrientNormals(const Eigen::Matrix3Xd& points, const Sensors& sensors, int neighbours,
                          Eigen::Matrix3Xd* normals) {
  CHECK_EQ(points.cols(), normals->cols());
  Orientation result;
  if (points.cols() == 0) return result;
  const NeighbourGraph graph = BuildGraph(points, neighbours);
  if (sensors.seen_by.size() == points.cols()) {
    result.method = OrientationMethod::kSensorOfEachPoint;
    FaceOwnSensor(points, sensors, graph, normals);
    result.disagreement = Disagreement(points, graph, *normals);
    return result;
  }
  const std::vector<int> part = Propagate(points, graph, normals);
  result.component_count = 1 + *std::max_element(part.begin(), part.end());
  const bool has_sensors = sensors.positions.cols() > 0;
  result.method = has_sensors ? OrientationMethod::kSensorsAround : OrientationMethod::kPropagation;
  const Eigen::VectorXd vote =
      has_sensors ? VoteBySensors(points, *normals, sensors.positions, part, result.component_count)
                  : VoteByExtremes(points, *normals, part, result.component_count);
  constexpr double kClear = 0.2;  // on the scale of `vote`, from 0 to 1
  for (const double v : vote) result.doubtful_component_count += std::abs(v) < kClear;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if (vote[part[i]] < 0) normals->col(i) *= -1;
  }
  result.disagreement = Disagreement(points, graph, *normals);
  return result;
}

}  // namespace lacuna
