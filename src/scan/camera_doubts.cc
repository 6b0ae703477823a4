#include "scan/camera_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/tri_mesh.h"

namespace lacuna {
namespace {

double Degrees(double radians) { return radians * 180 / std::numbers::pi; }

// "; they suit images of twice this width and height" where both coordinates of the principal
// point say so; empty otherwise.
std::string SuggestedScale(const Intrinsics& k, int width, int height) {
  // Centres of pixels have whole coordinates.
  const double of_width = (2 * k.cx + 1) / width, of_height = (2 * k.cy + 1) / height;
  if (!(of_width > 0) || std::abs(of_width - of_height) > 0.15 * of_width) return "";
  const double scale = 0.5 * (of_width + of_height);
  return fmt::format(
      "; it suits images of {:.0f} × {:.0f} pixels: if the images were scaled, fx, fy, cx and "
      "cy must be scaled as well (here by {:.3g})",
      scale * width, scale * height, 1 / scale);
}

// The largest distance between the middles of two views.
double Spread(const std::vector<Eigen::Matrix3Xd>& views) {
  double largest = 0;
  for (size_t a = 0; a < views.size(); ++a) {
    for (size_t b = 0; b < a; ++b) {
      if (views[a].cols() == 0 || views[b].cols() == 0) continue;
      largest = std::max(largest, (views[a].rowwise().mean() - views[b].rowwise().mean()).norm());
    }
  }
  return largest;
}

// The number of a view that touches no other; −1 if there is none.
int LonelyView(const std::vector<Eigen::Matrix3Xd>& views) {
  for (size_t a = 0; a < views.size(); ++a) {
    if (views[a].cols() == 0) continue;
    Eigen::AlignedBox3d box = BoundingBox(views[a]);
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(box.diagonal().norm());
    box = Eigen::AlignedBox3d(box.min() - margin, box.max() + margin);
    bool has_neighbour = false, has_other = false;
    for (size_t b = 0; b < views.size(); ++b) {
      if (b == a || views[b].cols() == 0) continue;
      has_other = true;
      has_neighbour = has_neighbour || box.intersects(BoundingBox(views[b]));
    }
    if (has_other && !has_neighbour) return static_cast<int>(a);
  }
  return -1;
}

}  // namespace

std::string DoubtOfIntrinsics(const Intrinsics& intrinsics, int width, int height) {
  const bool is_outside = intrinsics.cx < -0.5 || intrinsics.cy < -0.5 ||
                          intrinsics.cx > width - 0.5 || intrinsics.cy > height - 0.5;
  const auto is_far = [](double place, int size) {
    return std::abs(place - 0.5 * (size - 1)) > std::max(0.2 * size, 2.0);
  };
  const bool is_aside = is_far(intrinsics.cx, width) || is_far(intrinsics.cy, height);
  if (is_aside) {
    return fmt::format("the principal point ({:g}, {:g}) lies {} the images of {} × {} pixels{}",
                       intrinsics.cx, intrinsics.cy,
                       is_outside ? "outside" : "far from the middle of", width, height,
                       SuggestedScale(intrinsics, width, height));
  }
  const double across = Degrees(2 * std::atan(0.5 * width / intrinsics.fx));
  const double down = Degrees(2 * std::atan(0.5 * height / intrinsics.fy));
  for (const double view : {across, down}) {
    if (view >= 1 && view <= 140) continue;
    return fmt::format(
        "images of {} × {} pixels with fx: {:g}, fy: {:g} show {:.3g}° × {:.3g}°; focal lengths "
        "are in pixels of these images",
        width, height, intrinsics.fx, intrinsics.fy, across, down);
  }
  if (intrinsics.fx > 1.2 * intrinsics.fy || intrinsics.fy > 1.2 * intrinsics.fx) {
    return fmt::format("fx: {:g} and fy: {:g} differ, as if pixels were not square", intrinsics.fx,
                       intrinsics.fy);
  }
  return "";
}

std::string DoubtOfPoses(const std::vector<Eigen::Matrix3Xd>& views,
                         const std::vector<Camera>& cameras, bool are_inverse) {
  const int lonely = LonelyView(views);
  std::vector<Eigen::Matrix3Xd> others;
  for (size_t c = 0; c < views.size(); ++c) {
    const Eigen::Isometry3d camera_from_world = cameras[c].world_from_camera.inverse();
    others.push_back(camera_from_world * (camera_from_world * views[c]));
  }
  const double spread = Spread(views), other_spread = Spread(others);
  const bool would_be_closer = other_spread < 0.5 * spread && LonelyView(others) < 0;
  double largest = 0;
  for (const Eigen::Matrix3Xd& view : views) largest = std::max(largest, BoundingBoxDiagonal(view));
  if (lonely < 0 && !(would_be_closer && spread > largest)) return "";
  std::string text =
      lonely >= 0 ? fmt::format("{}: nothing that it sees is near what another camera sees; ",
                                cameras[static_cast<size_t>(lonely)].name)
                  : std::string("the views hardly overlap; ");
  text += fmt::format("the centres of the views are up to {:.3g} m apart", spread);
  if (would_be_closer) {
    return text + fmt::format(", and only {:.3g} m with {} in place of {}", other_spread,
                              are_inverse ? "world_from_camera" : "camera_from_world",
                              are_inverse ? "camera_from_world" : "world_from_camera");
  }
  return text + "; check the poses of the cameras and the intrinsics";
}

}  // namespace lacuna
