#include "plan/clamp_clearance.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "core/error.h"
#include "effects/plane_contact.h"
#include "scan/region.h"

namespace lacuna {
namespace {

// A clamp may enter a plane of contact by this much, m, as rounding makes it.
constexpr double kTouching = 1e-6;

// How far the lowest node of the grip's region reaches above the plane, m, at the lowest of these
// times (s); negative behind it. With the time at which it does.
struct Clearance {
  double height = std::numeric_limits<double>::infinity(), time = 0;
};
Clearance ClearanceOf(const RecordedGrip& grip, const ContactPlane& plane, const TetMesh& mesh,
                      const std::vector<double>& times) {
  const Eigen::Vector3d normal = plane.normal.normalized();
  const Eigen::Matrix3Xd rest = mesh.nodes(Eigen::all, SelectNodes(grip.region, mesh));
  Clearance least;
  for (const double time : times) {
    const double height =
        (normal.transpose() * (MotionAt(grip, time) * rest)).minCoeff() - plane.offset;
    if (height < least.height) least = {height, time};
  }
  return least;
}

}  // namespace

void RequireClampAbovePlanes(const GripsOverTime& planned, const GripsOverTime& recorded,
                             const EffectList& effects, const TetMesh& mesh) {
  for (const auto& effect : effects) {
    const std::optional<ContactPlane> plane = ContactPlaneOf(*effect);
    if (!plane) continue;
    for (size_t k = 0; k < planned.grips.size(); ++k) {
      const RecordedGrip& grip = planned.grips[k];
      if (grip.motion != GripMotion::kGiven) continue;
      const Clearance after = ClearanceOf(grip, *plane, mesh, planned.times);
      const Clearance before = ClearanceOf(recorded.grips[k], *plane, mesh, recorded.times);
      if (after.height < std::min(before.height, 0.0) - kTouching)
        throw InputError(fmt::format(
            "at {:.3g} s {} would be {:.3g} mm behind the plane of contact of the model",
            after.time, grip.region.name, -1e3 * after.height));
    }
  }
}

}  // namespace lacuna
