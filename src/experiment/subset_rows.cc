#include "experiment/subset_rows.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <map>
#include <vector>

#include "geometry/embedding.h"
#include "geometry/nearest.h"

namespace lacuna {
namespace {

// Samples along the edge of a subset, in the middles of as many parts. More: the mean over a subset
// is more exact, and larger matrices.
constexpr int kSamples = 5;
// A sample of a square that is farther from the surface than this share of the edge lies beyond an
// edge of the object.
constexpr double kBeyond = 0.1;

double Offset(int i, double edge) { return edge * ((i + 0.5) / kSamples - 0.5); }

// Sample points of one subset, and their coordinates relative to its middle: 2 or 3 × samples, m.
struct Samples {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::VectorXd> local;
};

Samples OfSquare(const Eigen::Vector3d& place, double edge, const TriMesh& surface,
                 const SurfaceSearch& search) {
  const Eigen::Vector3i corners = surface.triangles.col(search.Nearest(place).triangle[0]);
  const Eigen::Vector3d a = surface.vertices.col(corners[0]);
  const Eigen::Vector3d normal = (surface.vertices.col(corners[1]) - a)
                                     .cross(surface.vertices.col(corners[2]) - a)
                                     .normalized();
  Eigen::Index along = 0;  // the coordinate axis that lies flattest on the surface
  normal.cwiseAbs().minCoeff(&along);
  const Eigen::Vector3d axis = Eigen::Vector3d::Unit(along);
  const Eigen::Vector3d first = (axis - normal.dot(axis) * normal).normalized();
  const Eigen::Vector3d second = normal.cross(first);
  Eigen::Matrix3Xd flat(3, kSamples * kSamples);
  for (int i = 0; i < kSamples; ++i)
    for (int j = 0; j < kSamples; ++j)
      flat.col(i * kSamples + j) = place + Offset(i, edge) * first + Offset(j, edge) * second;
  const SurfaceHits hits = search.Nearest(flat);
  Samples samples;
  for (Eigen::Index k = 0; k < flat.cols(); ++k) {
    if (hits.distance[k] > kBeyond * edge) continue;
    const Eigen::Vector3d from = hits.point.col(k) - place;
    samples.points.emplace_back(hits.point.col(k));
    samples.local.emplace_back(Eigen::Vector2d(from.dot(first), from.dot(second)));
  }
  return samples;
}

Samples OfCube(const Eigen::Vector3d& place, double edge, const TetMesh& mesh) {
  Eigen::Matrix3Xd all(3, kSamples * kSamples * kSamples);
  for (int k = 0; k < all.cols(); ++k)
    all.col(k) =
        place + Eigen::Vector3d(Offset(k % kSamples, edge), Offset(k / kSamples % kSamples, edge),
                                Offset(k / (kSamples * kSamples), edge));
  const Embedding embedded = Embed(mesh, all);
  Samples samples;
  for (Eigen::Index k = 0; k < all.cols(); ++k) {
    if (embedded.outside[k] > 0) continue;
    samples.points.emplace_back(all.col(k));
    samples.local.emplace_back(all.col(k) - place);
  }
  return samples;
}

// The weights with which values at the samples give that of their affine fit in the middle.
Eigen::VectorXd WeightsInTheMiddle(const std::vector<Eigen::VectorXd>& local) {
  const Eigen::Index count = static_cast<Eigen::Index>(local.size());
  const Eigen::Index dimension = local.front().size();
  Eigen::MatrixXd affine(count, 1 + dimension);
  for (Eigen::Index k = 0; k < count; ++k)
    affine.row(k) << 1, local[static_cast<size_t>(k)].transpose();
  // Where the samples span a line only, across which the function is not determined, the
  // pseudo-inverse takes it for constant.
  return affine.completeOrthogonalDecomposition().pseudoInverse().row(0).transpose();
}

}  // namespace

ObservationMatrix SubsetRows(const TetMesh& mesh, const Eigen::Matrix3Xd& places,
                             const Instrument& instrument) {
  const TriMesh surface = ExtractBoundary(mesh).surface;
  const SurfaceSearch search(surface);
  std::vector<Eigen::Vector3d> points;
  std::vector<double> share;
  std::vector<size_t> end;  // of the samples of each place
  for (const Eigen::Vector3d place : places.colwise()) {
    Samples samples = instrument.is_volume ? OfCube(place, instrument.subset, mesh)
                                           : OfSquare(place, instrument.subset, surface, search);
    if (samples.points.empty()) {  // beside the object: its place alone
      samples.points.push_back(place);
      samples.local.emplace_back(Eigen::Vector2d::Zero());
    }
    const Eigen::VectorXd weights = WeightsInTheMiddle(samples.local);
    points.insert(points.end(), samples.points.begin(), samples.points.end());
    share.insert(share.end(), weights.begin(), weights.end());
    end.push_back(points.size());
  }
  Eigen::Matrix3Xd all(3, static_cast<Eigen::Index>(points.size()));
  for (size_t k = 0; k < points.size(); ++k) all.col(static_cast<Eigen::Index>(k)) = points[k];
  const Embedding embedded = Embed(mesh, all);
  ObservationMatrix rows;
  size_t sample = 0;
  for (const size_t last : end) {
    std::map<int, double> weight;  // by node
    for (; sample < last; ++sample) {
      const Eigen::Index k = static_cast<Eigen::Index>(sample);
      for (Eigen::Index a = 0; a < embedded.weight.rows(); ++a)
        weight[mesh.tets(a, embedded.tet[k])] += share[sample] * embedded.weight(a, k);
    }
    for (int axis = 0; axis < 3; ++axis) {
      for (const auto& [node, value] : weight) {
        rows.column.push_back(3 * node + axis);
        rows.weight.push_back(value);
      }
      rows.begin.push_back(static_cast<int>(rows.column.size()));
    }
  }
  return rows;
}

}  // namespace lacuna
