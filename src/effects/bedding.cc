#include "effects/bedding.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>

#include "core/error.h"
#include "effects/rest_region.h"
#include "effects/vector_parameters.h"
#include "geometry/tri_mesh.h"

namespace lacuna {
namespace {

constexpr Dimension kBeddingModulus{-2, 1, -2, 0, 0, "a pressure per length", "1 MPa/m", "Pa/m"};

// Whether no node with an area is near the point. (A fit may make the radius so small that no node
// is within its reach; that is no mistake of the user.)
bool IsFarFrom(const Eigen::VectorXd& areas, const Eigen::Vector3d& point, const Body& body) {
  const double near = 0.1 * BoundingBoxDiagonal(body.mesh.nodes);
  for (int i = 0; i < body.NodeCount(); ++i)
    if (areas[i] > 0 && (body.mesh.nodes.col(i) - point).norm() < near) return false;
  return true;
}

}  // namespace

ParameterCard BeddingModulus() {
  return {.name = "modulus",
          .meaning = "pressure per displacement, k",
          .dimension = kBeddingModulus,
          .bounds = kNotNegative,
          .null_value = 0,
          .plausible_min = 0,
          .plausible_max = 1e7,
          .of_body = true,
          .default_value = kMustBeGiven};
}

void AppendBeddedPart(EffectCard* card) {
  AppendVector({.name = "point",
                .meaning = "a point of the plane that bounds the supported part, and the centre "
                           "of its radius, c,",
                .dimension = kLength,
                .null_value = kNoNullValue,
                .plausible_min = -1,
                .plausible_max = 1},
               Eigen::Vector3d::Zero(), card);
  AppendDirectionSetting("normal",
                         "the support holds the boundary nodes that at rest lie on this side "
                         "of the plane; if omitted, on both sides;",
                         Eigen::Vector3d::Zero(), card);
  card->parameters.push_back({.name = "radius",
                              .meaning = "the support fades within this distance of the point "
                                         "(standard deviation), r; 0: it does not fade, and "
                                         "neither point nor radius can be fitted",
                              .dimension = kLength,
                              .bounds = kNotNegative,
                              .null_value = kNoNullValue,
                              .plausible_min = 0.001,
                              .plausible_max = 0.1,
                              .of_body = true,
                              .default_value = 0,
                              .log_scale = true,
                              .trial = {.share_of_length = 0.1}});
  AppendDirectionSetting(
      "side",
      "the support lies against the side of the body that at rest faces this "
      "outward direction (within about 45°); if omitted, around its whole girth;",
      Eigen::Vector3d::Zero(), card);
}

void BeddedPart::SetParameters(const Eigen::VectorXd& values) {
  CHECK_GT(values.size(), kCount);
  values_ = values.tail<kCount>();
  areas_.SetSettings(values_);
}

std::shared_ptr<const Eigen::VectorXd> BeddedPart::Areas(const Body& body,
                                                         const std::string& type) const {
  return areas_.Of(body, [&type](const Body& at_rest, const Eigen::VectorXd& values) {
    const Eigen::Vector3d point = values.segment<3>(kPoint);
    const double radius = values[kRadius];
    const Eigen::VectorXd part =
        FacingAreas(values.segment<3>(kSide), at_rest)
            .cwiseProduct(InHalfSpace(point, values.segment<3>(kNormal), at_rest));
    Eigen::VectorXd areas = part;
    if (radius > 0) areas = areas.cwiseProduct(BumpAround(point, radius, at_rest));
    if (areas.sum() == 0 && IsFarFrom(part, point, at_rest)) {
      throw InputError(fmt::format(
          "effect {}: no node of the body's surface lies on the side of its plane that `point` and "
          "`normal` name, on the `side` of the body, or within its radius",
          type));
    }
    return areas;
  });
}

Eigen::VectorXd BeddedPart::AreaDerivatives(const Body& body, const std::string& type,
                                            int parameter) const {
  CHECK((parameter >= kPoint && parameter < kNormal) || parameter == kRadius)
      << "the others are settings";
  if (Radius() == 0) return Eigen::VectorXd::Zero(body.NodeCount());
  const Eigen::Matrix3Xd arm = body.mesh.nodes.colwise() - Point();
  const double squared = Radius() * Radius();
  Eigen::RowVectorXd by_log = arm.row(std::min(parameter - kPoint, 2)) / squared;
  if (parameter == kRadius) by_log = arm.colwise().squaredNorm() / (squared * Radius());
  return Areas(body, type)->cwiseProduct(by_log.transpose());
}

}  // namespace lacuna
