#include "geometry/component_volume.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lacuna {

ComponentVolume::ComponentVolume(const Eigen::AlignedBox3d& box)
    : centre_(box.center()),
      largest_coordinate_(
          std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff())) {}

void ComponentVolume::Add(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                          const Eigen::Vector3d& c) {
  const Eigen::Vector3d from_centre = a - centre_;
  const Eigen::Vector3d cross = (b - centre_ - from_centre).cross(c - centre_ - from_centre);
  volume_ += from_centre.dot(cross) / 6;
  area_ += 0.5 * cross.norm();
}

bool ComponentVolume::IsFlat() const {
  const double rounding = 8 * std::numeric_limits<double>::epsilon() * largest_coordinate_ * area_;
  return std::abs(volume_) <= rounding;
}

}  // namespace lacuna
