#include "geometry/polygon_triangles.h"

#include <glog/logging.h>

#include <Eigen/Geometry>

namespace lacuna {
namespace {

using Triangles = std::vector<std::array<int, 3>>;

// A triangle with less than this share of the area of the polygon counts as flat.
constexpr double kFlatShare = 1e-14;
// How often all corners of a polygon are tested for ears.
constexpr int kMostTests = 8;

// Twice the signed area of a triangle in the plane.
double TwiceArea(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const Eigen::Vector2d u = b - a, v = c - a;
  return u.x() * v.y() - u.y() * v.x();
}

Triangles Fan(int n) {
  Triangles fan;
  for (int k = 1; k + 1 < n; ++k) fan.push_back({0, k, k + 1});
  return fan;
}

// The corners of a polygon in the plane that have not been clipped, as a cyclic list.
class EarClipper {
 public:
  // `flat`: twice the area up to which a triangle counts as flat.
  EarClipper(const Eigen::Matrix2Xd& corners, double flat)
      : corners_(corners), flat_(flat), left_(static_cast<int>(corners.cols())) {
    for (int i = 0; i < left_; ++i) {
      previous_.push_back((i + left_ - 1) % left_);
      next_.push_back((i + 1) % left_);
    }
  }

  // No triangles if no ear is left before the end.
  Triangles Run() {
    std::vector<char> is_ear(previous_.size());
    const auto test_all = [&](int from) {
      bool has_ear = false;
      for (int k = 0, i = from; k < left_; ++k, i = next_[i]) {
        is_ear[i] = IsEar(i) ? 1 : 0;
        has_ear = has_ear || is_ear[i] != 0;
      }
      return has_ear;
    };
    if (!test_all(0)) return {};
    Triangles triangles;
    for (int i = 0, tests = 1; left_ > 3;) {
      int tried = 0;
      for (; tried < left_ && is_ear[i] == 0; ++tried) i = next_[i];
      if (tried == left_) {
        // A corner in the way of another one, on an edge of its triangle, may have been clipped.
        if (++tests > kMostTests || !test_all(i)) return {};
        continue;
      }
      const int before = previous_[i], after = next_[i];
      triangles.push_back({before, i, after});
      next_[before] = after;
      previous_[after] = before;
      --left_;
      is_ear[before] = IsEar(before) ? 1 : 0;
      is_ear[after] = IsEar(after) ? 1 : 0;
      i = next_[after];  // rather than the next ear at the same corner, which gives slivers
      if (left_ == 3) triangles.push_back({previous_[i], i, next_[i]});
    }
    return triangles;
  }

 private:
  // Whether the triangle at corner i has an area and contains no other corner.
  bool IsEar(int i) const {
    const Eigen::Vector2d a = corners_.col(previous_[i]), b = corners_.col(i),
                          c = corners_.col(next_[i]);
    if (!(TwiceArea(a, b, c) > flat_)) return false;
    for (int k = next_[next_[i]]; k != previous_[i]; k = next_[k]) {
      const Eigen::Vector2d p = corners_.col(k);
      // Two corners coincide where a hole is joined to the rim by a pair of edges.
      if (p == a || p == b || p == c) continue;
      if (TwiceArea(a, b, p) >= 0 && TwiceArea(b, c, p) >= 0 && TwiceArea(c, a, p) >= 0)
        return false;
    }
    return true;
  }

  const Eigen::Matrix2Xd& corners_;
  double flat_;
  int left_;
  std::vector<int> previous_, next_;
};

}  // namespace

std::vector<std::array<int, 3>> CutPolygon(const Eigen::Matrix3Xd& corners) {
  const int n = static_cast<int>(corners.cols());
  CHECK_GE(n, 3);
  if (n == 3) return Fan(n);
  const Eigen::Matrix3Xd from_first = corners.colwise() - corners.col(0);
  const auto twice_area = [&](int k) -> Eigen::Vector3d {
    return from_first.col(k).cross(from_first.col(k + 1));
  };
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  for (int k = 1; k + 1 < n; ++k) area += twice_area(k);
  const double size = area.stableNorm();
  if (!(size > 0)) return Fan(n);
  const Eigen::Vector3d normal = area / size;
  bool is_seen_from_first = true;
  for (int k = 1; k + 1 < n; ++k)
    is_seen_from_first = is_seen_from_first && twice_area(k).dot(normal) > kFlatShare * size;
  if (is_seen_from_first) return Fan(n);

  Eigen::Matrix<double, 2, 3> plane;
  plane.row(0) = normal.unitOrthogonal();
  plane.row(1) = normal.cross(Eigen::Vector3d(plane.row(0)));
  const Eigen::Matrix2Xd flat = plane * from_first;
  const Triangles triangles = EarClipper(flat, kFlatShare * size).Run();
  return triangles.empty() ? Fan(n) : triangles;
}

}  // namespace lacuna
