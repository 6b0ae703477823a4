#include "geometry/embedding.h"

#include <glog/logging.h>

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <tuple>

#include "core/parallel.h"
#include "geometry/box_tree.h"
#include "geometry/nearest.h"
#include "geometry/shape_functions.h"

namespace lacuna {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector4d;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
// For a point outside the mesh, the number of tetrahedra with the nearest centroids whose
// extrapolation is tried.
constexpr int kCandidates = 48;
// Boxes are enlarged by this share of their diagonal, so that a point on a face is not lost to
// rounding.
constexpr double kMargin = 1e-9;
// A point whose least coordinate is not below this lies in the enlarged box of every tetrahedron
// whose least coordinate is greater, so no other need be tried.
constexpr double kNearlyInside = -1e-10;
// Points located by one task of a parallel loop.
constexpr int64_t kPointsPerTask = 256;

// The derivatives (3 × 4, 1/m) of barycentric coordinates from ∂ξ_k/∂X of the last three.
Eigen::Matrix<double, 4, 3> OfAllFour(const Matrix3d& gradient) {
  Eigen::Matrix<double, 4, 3> all;
  all.bottomRows<3>() = gradient;
  all.row(0) = -all.bottomRows<3>().colwise().sum();
  return all;
}

// The matrix G (3 × 3, 1/m) with (ξ_1, ξ_2, ξ_3) = G (X − X_0) in a straight-edged tetrahedron.
Matrix3d StraightGradient(const TetMesh& mesh, int tet) {
  Matrix3d edges;
  for (int a = 0; a < 3; ++a)
    edges.col(a) = mesh.nodes.col(mesh.tets(a + 1, tet)) - mesh.nodes.col(mesh.tets(0, tet));
  return edges.inverse();
}

Vector4d StraightCoordinates(const TetMesh& mesh, int tet, const Vector3d& point) {
  const Vector3d inner = StraightGradient(mesh, tet) * (point - mesh.nodes.col(mesh.tets(0, tet)));
  return {1 - inner.sum(), inner[0], inner[1], inner[2]};
}

// The map x(ξ) = Σ_a N_a(ξ) x_a of a quadratic tetrahedron. Its origin is the first corner, so that
// rounding errors are relative to the size of the element.
class CurvedMap {
 public:
  CurvedMap(const TetMesh& mesh, int tet) : origin_(mesh.nodes.col(mesh.tets(0, tet))) {
    for (int a = 0; a < 10; ++a) nodes_.col(a) = mesh.nodes.col(mesh.tets(a, tet)) - origin_;
  }

  // X − x(ξ)
  Vector3d Miss(const Vector3d& point, const Vector4d& at) const {
    return point - origin_ - nodes_ * ShapeValues(2, at);
  }
  // ∂ξ/∂x of all four coordinates; not finite where the map is singular.
  Eigen::Matrix<double, 4, 3> Gradient(const Vector4d& at) const {
    const Matrix3d jacobian = nodes_ * ShapeDerivativesAlongEdges(2, at);
    return OfAllFour(jacobian.inverse());
  }

  // Solves x(ξ) = point by Newton's method with step halving, from `at`. Returns whether it
  // converged.
  bool Solve(const Vector3d& point, Vector4d* at) const {
    constexpr int kMostSteps = 30;
    constexpr double kShortestStep = 1e-3;  // relative to Newton's step
    const double rounding =
        8 * std::numeric_limits<double>::epsilon() * nodes_.cwiseAbs().maxCoeff();
    Vector3d miss = Miss(point, *at);
    for (int step = 0; step < kMostSteps && miss.norm() > rounding; ++step) {
      const Vector4d change = Gradient(*at) * miss;
      Vector4d next;
      Vector3d next_miss;
      double share = 1;
      // Where the map is singular, the step is not finite and no comparison holds.
      do {
        next = *at + share * change;
        next_miss = Miss(point, next);
        share *= 0.5;
      } while (!(next_miss.norm() < miss.norm()) && share >= kShortestStep);
      if (!(next_miss.norm() < miss.norm())) break;
      *at = next;
      miss = next_miss;
    }
    // Further steps may be prevented by rounding alone.
    return miss.norm() <= 100 * rounding;
  }

  // The coordinates with x(ξ) = point: inside the element if there are such, where they are unique
  // in a valid element, otherwise outside it and in the neighbourhood of the starts; all NaN if the
  // iterations do not converge.
  Vector4d Coordinates(const Vector3d& point, const Vector4d& straight) const {
    const Vector4d inside = straight.cwiseMax(0);
    Vector4d first = inside / inside.sum();
    const bool is_solved = Solve(point, &first);
    if (is_solved && first.minCoeff() >= 0) return first;
    Vector4d second = NearestPlace(point);
    if (!Solve(point, &second)) second.setConstant(std::numeric_limits<double>::quiet_NaN());
    return is_solved && !(second.minCoeff() > first.minCoeff()) ? first : second;
  }

 private:
  // The coordinates of the node or the centroid that is nearest to `point`.
  Vector4d NearestPlace(const Vector3d& point) const {
    Vector4d nearest = Vector4d::Constant(0.25);
    double distance = Miss(point, nearest).norm();
    const Eigen::Matrix4Xd places = NodeCoordinates(2);
    for (int a = 0; a < 10; ++a) {
      const double of_node = (point - origin_ - nodes_.col(a)).norm();
      if (!(of_node < distance)) continue;
      distance = of_node;
      nearest = places.col(a);
    }
    return nearest;
  }

  Vector3d origin_;
  Eigen::Matrix<double, 3, 10> nodes_;
};

// A box around tetrahedron `tet`, curved or straight: around the control points of its Bézier form,
// whose convex hull contains it (Farin, Curves and Surfaces for CAGD).
Eigen::AlignedBox3d BoxAround(const TetMesh& mesh, Eigen::Index tet) {
  Eigen::AlignedBox3d box;
  for (int a = 0; a < 4; ++a) box.extend(mesh.nodes.col(mesh.tets(a, tet)));
  if (mesh.Order() == 2)
    for (int k = 0; k < 6; ++k) {
      const auto [a, b] = kTetEdges[static_cast<size_t>(k)];
      box.extend(2 * mesh.nodes.col(mesh.tets(4 + k, tet)) -
                 0.5 * (mesh.nodes.col(mesh.tets(a, tet)) + mesh.nodes.col(mesh.tets(b, tet))));
    }
  const Vector3d margin = Vector3d::Constant(kMargin * box.diagonal().norm());
  return {box.min() - margin, box.max() + margin};
}

struct Location {
  int tet = -1;
  Vector4d barycentric = Vector4d::Zero();
  double least = -kInfinite;    // coordinate
  double distance = kInfinite;  // squared, to the centroid, m²
  bool is_affine = false;       // whether the point was located by ConsiderAffine
};

class Locator {
 public:
  explicit Locator(const TetMesh& mesh)
      : mesh_(mesh),
        centroids_(3, mesh.TetCount()),
        is_straight_(static_cast<size_t>(mesh.TetCount())) {
    for (Eigen::Index e = 0; e < mesh.TetCount(); ++e) {
      is_straight_[static_cast<size_t>(e)] = HasStraightEdges(mesh, e) ? 1 : 0;
      centroids_.col(e).setZero();
      for (int a = 0; a < 4; ++a) centroids_.col(e) += 0.25 * mesh.nodes.col(mesh.tets(a, e));
    }
  }

  const Eigen::Matrix3Xd& centroids() const { return centroids_; }
  bool IsStraight(int tet) const { return is_straight_[static_cast<size_t>(tet)] != 0; }

  // Replaces `best` if the least coordinate of `point` in `tet` is greater, or equal and the
  // centroid nearer, so that the result does not depend on the order of the tetrahedra.
  void Consider(int tet, const Vector3d& point, Location* best) const {
    Vector4d at = StraightCoordinates(mesh_, tet, point);
    if (!IsStraight(tet)) at = CurvedMap(mesh_, tet).Coordinates(point, at);
    Keep(tet, at, point, /*is_affine=*/false, best);
  }
  // The same with the affine map of the centroid of a curved element, which exists for every point.
  void ConsiderAffine(int tet, const Vector3d& point, Location* best) const {
    if (IsStraight(tet)) return;
    const CurvedMap map(mesh_, tet);
    const Vector4d centre = Vector4d::Constant(0.25);
    Keep(tet, centre + map.Gradient(centre) * map.Miss(point, centre), point, /*is_affine=*/true,
         best);
  }

 private:
  void Keep(int tet, const Vector4d& at, const Vector3d& point, bool is_affine,
            Location* best) const {
    if (!at.allFinite()) return;
    const double least = at.minCoeff();
    const double distance = (centroids_.col(tet) - point).squaredNorm();
    if (std::tuple(-least, distance, tet) < std::tuple(-best->least, best->distance, best->tet))
      *best = {tet, at, least, distance, is_affine};
  }

  const TetMesh& mesh_;
  Eigen::Matrix3Xd centroids_;
  std::vector<char> is_straight_;
};

// The location of each point by the tetrahedra whose bounding boxes contain it. A point that is not
// finite, and one in no box, has no tetrahedron.
std::vector<Location> LocateInBoxes(const TetMesh& mesh, const Locator& locator,
                                    const Eigen::Matrix3Xd& points) {
  std::vector<Eigen::AlignedBox3d> boxes(static_cast<size_t>(mesh.TetCount()));
  for (size_t e = 0; e < boxes.size(); ++e)
    boxes[e] = BoxAround(mesh, static_cast<Eigen::Index>(e));
  const BoxTree tree(boxes);
  std::vector<Location> places(static_cast<size_t>(points.cols()));
  ParallelFor(points.cols(), kPointsPerTask, [&](int64_t j) {
    const Vector3d point = points.col(j);
    if (!point.allFinite()) return;
    tree.ForEachAround(
        point, [&](int tet) { locator.Consider(tet, point, &places[static_cast<size_t>(j)]); });
  });
  return places;
}

// Locates the finite points that are in no tetrahedron by those with the nearest centroids, too.
void LocateOutside(const Locator& locator, const Eigen::Matrix3Xd& points,
                   std::vector<Location>* places) {
  std::vector<Eigen::Index> outer;
  for (Eigen::Index j = 0; j < points.cols(); ++j)
    if (points.col(j).allFinite() && (*places)[static_cast<size_t>(j)].least < kNearlyInside)
      outer.push_back(j);
  if (outer.empty()) return;
  const Eigen::Index candidates = std::min<Eigen::Index>(kCandidates, locator.centroids().cols());
  const PointHits near = PointSearch(locator.centroids())
                             .Nearest(points(Eigen::all, outer), static_cast<int>(candidates));
  ParallelFor(static_cast<int64_t>(outer.size()), kPointsPerTask, [&](int64_t i) {
    const Eigen::Index j = outer[static_cast<size_t>(i)];
    const Vector3d point = points.col(j);
    Location* const place = &(*places)[static_cast<size_t>(j)];
    for (Eigen::Index k = 0; k < candidates; ++k) locator.Consider(near.index(k, i), point, place);
    if (place->tet >= 0) return;
    // Far from curved elements their quadratic maps may not reach the point.
    for (Eigen::Index k = 0; k < candidates; ++k)
      locator.ConsiderAffine(near.index(k, i), point, place);
    CHECK_GE(place->tet, 0) << "the tetrahedra around a point have no volume";
  });
}

}  // namespace

Embedding Embed(const TetMesh& mesh, const Eigen::Matrix3Xd& points) {
  CHECK_GT(mesh.TetCount(), 0) << "there is no tetrahedron to embed points in";
  const Locator locator(mesh);
  std::vector<Location> places = LocateInBoxes(mesh, locator, points);
  LocateOutside(locator, points, &places);

  constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Index nodes = mesh.tets.rows();
  Embedding embedding{
      Eigen::VectorXi::Constant(points.cols(), -1),
      Eigen::MatrixXd::Constant(nodes, points.cols(), kNotKnown),
      std::vector<Eigen::MatrixX3d>(places.size(), Eigen::MatrixX3d::Constant(nodes, 3, kNotKnown)),
      Eigen::VectorXd::Constant(points.cols(), kNotKnown)};
  ParallelFor(points.cols(), kPointsPerTask, [&](int64_t i) {
    const size_t j = static_cast<size_t>(i);
    const Location& place = places[j];
    if (place.tet < 0) return;  // a point that is not finite
    const Vector4d at = place.is_affine ? Vector4d::Constant(0.25).eval() : place.barycentric;
    const Eigen::Matrix<double, 4, 3> by_place = locator.IsStraight(place.tet)
                                                     ? OfAllFour(StraightGradient(mesh, place.tet))
                                                     : CurvedMap(mesh, place.tet).Gradient(at);
    embedding.tet[i] = place.tet;
    embedding.weight.col(i) = ShapeValues(mesh.Order(), at);
    embedding.gradient[j] = ShapeDerivatives(mesh.Order(), at) * by_place;
    if (place.is_affine)
      embedding.weight.col(i) +=
          embedding.gradient[j] * CurvedMap(mesh, place.tet).Miss(points.col(i), at);
    embedding.outside[i] = std::max(0.0, -place.least);
  });
  return embedding;
}

Eigen::Matrix3Xd PointsAt(const Embedding& embedding, const TetMesh& mesh,
                          const Eigen::Matrix3Xd& nodes) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, embedding.tet.size());
  for (Eigen::Index j = 0; j < points.cols(); ++j) {
    if (embedding.tet[j] < 0) {
      points.col(j).setConstant(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    for (Eigen::Index a = 0; a < mesh.tets.rows(); ++a)
      points.col(j) += embedding.weight(a, j) * nodes.col(mesh.tets(a, embedding.tet[j]));
  }
  return points;
}

Eigen::Matrix3d DeformationGradientAt(const Embedding& embedding, Eigen::Index j,
                                      const TetMesh& mesh,
                                      const Eigen::Ref<const Eigen::Matrix3Xd>& nodes) {
  Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
  for (Eigen::Index a = 0; a < mesh.tets.rows(); ++a)
    gradient += nodes.col(mesh.tets(a, embedding.tet[j])) *
                embedding.gradient[static_cast<size_t>(j)].row(a);
  return gradient;
}

}  // namespace lacuna
