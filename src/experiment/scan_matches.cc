#include "experiment/scan_matches.h"

#include <cmath>

#include "core/parallel.h"
#include "geometry/nearest.h"

namespace lacuna {
namespace {

constexpr double kMinNormalAgreement = 0.5;  // cos 60°
// A point lies beside a face if it is displaced from it tangentially by more than so many standard
// deviations of the noise. Smaller: noise at the edges, which only points outside of them show,
// biases the patches beyond; larger: outlines are less accurate.
constexpr double kBeside = 4;
// How far inside the edge the face is looked up to which a point beside it belongs, relative to the
// object's size: less than an element, more than rounding.
constexpr double kInside = 1e-3;

// Unit vectors along the face and its normal, which turn with the material.
Eigen::Matrix3d FaceFrame(const FacePoint& place, const BoundarySurface& boundary,
                          const Eigen::Ref<const Eigen::Matrix3Xd>& nodes,
                          const Eigen::Vector3d& normal) {
  Eigen::Vector3d tangent = Eigen::Vector3d::Zero();
  for (int a = 0; a < place.count; ++a)
    tangent += place.by_first[a] * nodes.col(boundary.faces(a, place.face));
  Eigen::Matrix3d frame;
  frame.col(0) = tangent.normalized();
  frame.col(1) = normal.cross(frame.col(0));
  frame.col(2) = normal;
  return frame;
}

// The nearest place of the surface for each point, with the surface's normal there.
struct Feet {
  std::vector<FacePoint> place;
  std::vector<FaceGeometry> now;
  Eigen::VectorXd distance;  // m
};

Feet FindFeet(const SurfaceSearch& search, const BoundarySurface& boundary,
              const Eigen::Ref<const Eigen::Matrix3Xd>& nodes, const Eigen::Matrix3Xd& points) {
  const SurfaceHits hits = search.Nearest(points);
  const size_t count = static_cast<size_t>(points.cols());
  Feet feet{std::vector<FacePoint>(count), std::vector<FaceGeometry>(count), hits.distance};
  ParallelFor(points.cols(), 256, [&](int64_t j) {
    if (hits.triangle[j] < 0) return;
    const size_t at = static_cast<size_t>(j);
    feet.place[at] = PlaceOnFace(boundary, hits.triangle[j], hits.barycentric.col(j));
    feet.now[at] = Evaluate(feet.place[at], boundary, nodes);
  });
  return feet;
}

// Whether `away`, from a place of the surface to its point, has a part along the surface that is
// more than noise, on the outside of a surface with this normal.
bool IsBeside(const Eigen::Vector3d& away, const Eigen::Vector3d& normal, double noise) {
  const double along = away.dot(normal);
  return along >= -kBeside * noise && (away - along * normal).norm() > kBeside * noise;
}

}  // namespace

ScanMatches MatchScan(const ScannedPoints& scan, const Body& body, const SurfacePatches& patches,
                      const Eigen::Ref<const Eigen::Matrix3Xd>& nodes, double reach, double depth) {
  const BoundarySurface& boundary = body.boundary;
  const Eigen::Matrix3Xd &points = scan.cloud.points, &normals = scan.cloud.normals;
  const double size = BoundingBoxDiagonal(body.mesh.nodes);
  const SurfaceSearch search(BoundaryAt(boundary, nodes));
  const Feet feet = FindFeet(search, boundary, nodes, points);
  ScanMatches found;
  found.matches.resize(static_cast<size_t>(points.cols()));
  if (points.cols() > 0) found.distance = feet.distance.cwiseMin(size).mean();

  // A foot on an edge belongs to two faces. The one that was scanned is found inside of its edge.
  std::vector<Eigen::Index> beside;
  Eigen::Matrix3Xd probes(3, points.cols());
  for (Eigen::Index j = 0; j < points.cols(); ++j) {
    const FaceGeometry& foot = feet.now[static_cast<size_t>(j)];
    if (!scan.points_out || !(feet.distance[j] <= reach)) continue;
    const Eigen::Vector3d away = points.col(j) - foot.position, normal = normals.col(j);
    if (!IsBeside(away, foot.normal, scan.noise) && !IsBeside(away, normal, scan.noise)) continue;
    const Eigen::Vector3d sideways = away - away.dot(normal) * normal;
    probes.col(static_cast<Eigen::Index>(beside.size())) =
        foot.position + kInside * size * (normal - sideways.normalized());
    beside.push_back(j);
  }
  const Feet faces =
      FindFeet(search, boundary, nodes, probes.leftCols(static_cast<Eigen::Index>(beside.size())));
  std::vector<Eigen::Vector3d> scanned_face(found.matches.size());
  for (size_t j = 0; j < scanned_face.size(); ++j) scanned_face[j] = feet.now[j].normal;
  for (size_t k = 0; k < beside.size(); ++k)
    scanned_face[static_cast<size_t>(beside[k])] = faces.now[k].normal;

  ParallelFor(points.cols(), 256, [&](int64_t j) {
    if (!(feet.distance[j] <= reach)) return;
    const size_t at = static_cast<size_t>(j);
    const double agreement = scanned_face[at].dot(normals.col(j));
    if (!((scan.points_out ? agreement : std::abs(agreement)) >= kMinNormalAgreement)) return;
    ScanMatch match;
    match.place = feet.place[at];
    const FaceGeometry& now = feet.now[at];
    const FaceGeometry rest = Evaluate(match.place, boundary, body.mesh.nodes);
    const Eigen::Vector3d away = points.col(j) - now.position;
    Eigen::Vector3d normal_at_rest = rest.normal;
    if (scan.points_out && IsBeside(away, scanned_face[at], scan.noise)) {
      match.normal = away.normalized();
      match.error = -away.norm();
      normal_at_rest = FaceFrame(match.place, boundary, body.mesh.nodes, rest.normal) *
                       FaceFrame(match.place, boundary, nodes, now.normal).transpose() *
                       match.normal;
    } else {
      match.normal = now.normal;
      match.depth = depth;
      match.error = -now.normal.dot(away) - depth;
    }
    match.patch = patches.PatchOf(rest.position, normal_at_rest);
    found.matches[at] = match;
  });
  return found;
}

}  // namespace lacuna
