#include "geometry/self_intersection.h"

#include <CGAL/Bbox_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <array>
#include <utility>

namespace lacuna {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, int>;

class PairTest {
 public:
  explicit PairTest(const TriMesh& mesh) : mesh_(mesh) {}

  bool HasNoArea(int t) const { return CGAL::collinear(Corner(t, 0), Corner(t, 1), Corner(t, 2)); }

  bool Intersect(int s, int t) const {
    // Turn each triangle so that the vertices they share come first, in the same order.
    std::array<int, 3> turn_s{0, 1, 2}, turn_t{0, 1, 2};
    int shared = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = shared; j < 3; ++j) {
        if (mesh_.triangles(turn_s[i], s) != mesh_.triangles(turn_t[j], t)) continue;
        std::swap(turn_s[shared], turn_s[i]);
        std::swap(turn_t[shared], turn_t[j]);
        ++shared;
        break;
      }
    }
    const Point a = Corner(s, turn_s[0]), b = Corner(s, turn_s[1]), c = Corner(s, turn_s[2]);
    const Point p = Corner(t, turn_t[0]), q = Corner(t, turn_t[1]), r = Corner(t, turn_t[2]);
    switch (shared) {
      case 0:
        return CGAL::do_intersect(Kernel::Triangle_3(a, b, c), Kernel::Triangle_3(p, q, r));
      case 1:  // any further meeting reaches the edge opposite the shared vertex of one of them
        return CGAL::do_intersect(Kernel::Segment_3(b, c), Kernel::Triangle_3(p, q, r)) ||
               CGAL::do_intersect(Kernel::Segment_3(q, r), Kernel::Triangle_3(a, b, c));
      case 2:  // only folded flat onto each other
        return CGAL::coplanar(a, b, c, r) &&
               CGAL::coplanar_orientation(a, b, c, r) == CGAL::POSITIVE;
      default:
        return true;
    }
  }

 private:
  Point Corner(int triangle, int corner) const {
    const auto v = mesh_.vertices.col(mesh_.triangles(corner, triangle));
    return {v.x(), v.y(), v.z()};
  }

  const TriMesh& mesh_;
};

Eigen::AlignedBox3d TriangleBox(const TriMesh& mesh, int triangle) {
  Eigen::AlignedBox3d box;
  for (int corner = 0; corner < 3; ++corner) {
    box.extend(Eigen::Vector3d(mesh.vertices.col(mesh.triangles(corner, triangle))));
  }
  return box;
}

}  // namespace

std::vector<SelfIntersection> FindSelfIntersections(const TriMesh& mesh) {
  const PairTest test(mesh);
  std::vector<Box> boxes;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    if (test.HasNoArea(t)) continue;
    const Eigen::AlignedBox3d box = TriangleBox(mesh, t);
    boxes.emplace_back(CGAL::Bbox_3(box.min().x(), box.min().y(), box.min().z(), box.max().x(),
                                    box.max().y(), box.max().z()),
                       t);
  }
  std::vector<std::pair<int, int>> pairs;
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& s, const Box& t) {
    if (test.Intersect(s.info(), t.info())) pairs.push_back(std::minmax(s.info(), t.info()));
  });
  std::sort(pairs.begin(), pairs.end());

  std::vector<SelfIntersection> intersections;
  intersections.reserve(pairs.size());
  for (const auto& [s, t] : pairs) {
    const Eigen::AlignedBox3d common = TriangleBox(mesh, s).intersection(TriangleBox(mesh, t));
    intersections.push_back({s, t, common.center()});
  }
  return intersections;
}

}  // namespace lacuna
