#include "experiment/scan_grips.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/error.h"
#include "core/median.h"
#include "geometry/nearest.h"
#include "geometry/rotation.h"

namespace lacuna {
namespace {

constexpr double kMinNormalAgreement = 0.5;  // cos 60°
constexpr int kFewestPoints = 50;
constexpr int kMostIterations = 40;
constexpr int kFullSteps = 5;
// The median distance of the points from the part may be at most kMostNoise times the noise plus
// kMostMisfit times the part's radius, which corresponds to a rotation error of about kMostMisfit
// rad.
constexpr double kMostNoise = 1.5;
constexpr double kMostMisfit = 0.01;
// The smallest mean square displacement along the normals that a unit motion in any direction must
// cause.
constexpr double kLeastShown = 0.005;

using Twist = Eigen::Matrix<double, 6, 1>;

// The triangles whose corners are all gripped, and which of their edges lie on the rim.
struct Part {
  TriMesh surface;
  std::vector<std::array<bool, 3>> rim;  // for each triangle: is the edge opposite corner i on it
  Eigen::Matrix3Xd normals;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0;
};

Part MakePart(const BoundarySurface& boundary, const ScannedGrip& grip) {
  std::vector<char> gripped(static_cast<size_t>(boundary.node.maxCoeff() + 1), 0);
  for (const int node : grip.nodes)
    if (node < static_cast<int>(gripped.size())) gripped[node] = 1;
  std::vector<Eigen::Index> chosen;
  for (Eigen::Index t = 0; t < boundary.surface.triangles.cols(); ++t) {
    bool all = true;
    for (const int vertex : boundary.surface.triangles.col(t))
      all = all && gripped[boundary.node[vertex]];
    if (all) chosen.push_back(t);
  }
  if (chosen.empty())
    throw InputError(fmt::format(
        "{} follows the scan, but contains no face of the surface: enlarge its region", grip.name));
  Part part;
  part.surface = {boundary.surface.vertices, boundary.surface.triangles(Eigen::all, chosen)};
  part.normals = TriangleNormals(part.surface);
  std::map<std::pair<int, int>, int> triangles_at;
  const auto edge = [&part](Eigen::Index t, int corner) {
    const int a = part.surface.triangles((corner + 1) % 3, t);
    const int b = part.surface.triangles((corner + 2) % 3, t);
    return std::minmax(a, b);
  };
  for (Eigen::Index t = 0; t < part.surface.triangles.cols(); ++t)
    for (int corner = 0; corner < 3; ++corner) ++triangles_at[edge(t, corner)];
  Eigen::AlignedBox3d box;
  for (Eigen::Index t = 0; t < part.surface.triangles.cols(); ++t) {
    std::array<bool, 3> rim;
    for (int corner = 0; corner < 3; ++corner) {
      rim[corner] = triangles_at[edge(t, corner)] == 1;
      box.extend(part.surface.vertices.col(part.surface.triangles(corner, t)));
    }
    part.rim.push_back(rim);
  }
  part.centre = box.center();
  part.radius = 0.5 * box.diagonal().norm();
  return part;
}

bool IsOnRim(const Part& part, int triangle, const Eigen::Vector3d& barycentric) {
  for (int corner = 0; corner < 3; ++corner)
    if (part.rim[triangle][corner] && barycentric[corner] < 1e-6) return true;
  return false;
}

// The result of one linearised fit of the part to the points. Rotations are about the centre and in
// units of the radius, so that all six components are lengths.
struct Fit {
  int points = 0;
  double shown = 0;  // smallest eigenvalue of the mean of J Jᵀ
  Twist step = Twist::Zero();
  double median = 0;  // m, distance of the points from the part
};

Fit FitOnce(const Part& part, const SurfaceSearch& search, const ScannedPoints& scan,
            const Eigen::Isometry3d& motion, double reach) {
  const Eigen::Isometry3d back = motion.inverse();
  const Eigen::Matrix3Xd points =
      (back.linear() * scan.cloud.points).colwise() + back.translation();
  const SurfaceHits hits = search.Nearest(points);
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  Twist right = Twist::Zero();
  std::vector<double> distances;
  Fit fit;
  for (Eigen::Index j = 0; j < points.cols(); ++j) {
    if (!(hits.distance[j] <= reach)) continue;
    const Eigen::Vector3d normal = part.normals.col(hits.triangle[j]);
    const double agreement = normal.dot(back.linear() * scan.cloud.normals.col(j));
    if ((scan.points_out ? agreement : std::abs(agreement)) < kMinNormalAgreement) continue;
    if (IsOnRim(part, hits.triangle[j], hits.barycentric.col(j))) continue;
    const Eigen::Vector3d arm = (hits.point.col(j) - part.centre) / part.radius;
    Twist direction;
    direction << arm.cross(normal), normal;
    const double error = normal.dot(points.col(j) - hits.point.col(j));
    information += direction * direction.transpose();
    right += error * direction;
    distances.push_back(std::abs(error));
  }
  fit.points = static_cast<int>(distances.size());
  if (fit.points < kFewestPoints) return fit;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(information / fit.points);
  fit.shown = eigen.eigenvalues()[0];
  if (fit.shown < kLeastShown) return fit;
  fit.step = information.ldlt().solve(right);
  fit.median = Median(std::move(distances));
  return fit;
}

Eigen::Isometry3d MotionOf(const Part& part, const Twist& step) {
  const Eigen::Vector3d turn = step.head<3>() / part.radius;
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = RotationBy(turn);
  motion.translation() = part.centre + step.tail<3>() - motion.linear() * part.centre;
  return motion;
}

}  // namespace

std::vector<Eigen::Isometry3d> FollowGrip(const ScanFrames& scans, const std::vector<int>& frames,
                                          const BoundarySurface& boundary,
                                          const ScannedGrip& grip) {
  const Part part = MakePart(boundary, grip);
  const SurfaceSearch search(part.surface);
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Isometry3d> motions;
  for (const int frame : frames) {
    const ScannedPoints& scan = scans.At(frame);
    const auto fail = [&](const std::string& message) -> InputError {
      return InputError(fmt::format(
          "{}: {} follows the scan, but frame {} {}; give its motion as a `path`, or choose a "
          "region that the scans show",
          scans.recording().file.string(), grip.name, frame, message));
    };
    double reach = grip.reach;
    for (int iteration = 0; iteration < kMostIterations; ++iteration) {
      const Fit fit = FitOnce(part, search, scan, motion, reach);
      if (fit.points < kFewestPoints)
        throw fail(fmt::format("shows {} points of it; at least {} are needed", fit.points,
                               kFewestPoints));
      if (fit.shown < kLeastShown)
        throw fail(
            "does not determine all of its motion: the part that is seen is flat or round and "
            "could slide unnoticed");
      const bool is_last = iteration + 1 == kMostIterations;
      if (is_last && fit.step.norm() > 2 * std::max(fit.median, scan.noise))
        throw fail("could not be followed: the fit does not converge");
      // Points that move from one triangle to another keep the full steps from vanishing, so that
      // later steps are averaged.
      const double gain = iteration < kFullSteps ? 1 : 1.0 / (iteration - kFullSteps + 2);
      motion = motion * MotionOf(part, gain * fit.step);
      const bool settled = gain * fit.step.norm() < std::max(1e-3 * scan.noise, 1e-9);
      const double allowed = kMostNoise * scan.noise + kMostMisfit * part.radius;
      if ((settled || is_last) && fit.median > allowed)
        throw fail(fmt::format(
            "is {:.2f} mm away from its surface, more than the {:.2f} mm expected from noise and "
            "a fine mesh: the undeformed surface is too coarse or wrong there",
            1e3 * fit.median, 1e3 * allowed));
      if (settled) break;
      // Points that are still far away after a few steps do not belong to the part.
      if (iteration + 1 == kFullSteps)
        reach = std::min(grip.reach, 6 * std::max(fit.median, scan.noise));
    }
    motions.push_back(motion);
  }
  if (grip.rests_at_first) {
    const Eigen::Isometry3d back = motions.front().inverse();
    for (Eigen::Isometry3d& each : motions) each = each * back;
  }
  return motions;
}

}  // namespace lacuna
