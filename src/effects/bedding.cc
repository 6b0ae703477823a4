#include "effects/bedding.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include "core/error.h"
#include "effects/rest_region.h"
#include "effects/vector_parameters.h"

namespace lacuna {
namespace {

constexpr Dimension kBeddingModulus{-2, 1, -2, 0, 0, "a pressure per length", "1 MPa/m", "Pa/m"};

}  // namespace

ParameterCard BeddingModulus() {
  return {.name = "modulus",
          .meaning = "pressure per displacement, k",
          .dimension = kBeddingModulus,
          .bounds = kNotNegative,
          .null_value = 0,
          .plausible_min = 0,
          .plausible_max = 1e7,
          .default_value = kMustBeGiven};
}

void AppendBeddedPart(EffectCard* card) {
  AppendVector({.name = "point",
                .meaning = "a point of the plane that bounds the supported part, and the centre "
                           "of its radius, c,",
                .dimension = kLength,
                .null_value = kNoNullValue,
                .plausible_min = -1,
                .plausible_max = 1,
                .setting = true},
               Eigen::Vector3d::Zero(), card);
  AppendDirectionSetting("normal",
                         "the support holds the boundary nodes that at rest lie on this side "
                         "of the plane; if omitted, on both sides;",
                         Eigen::Vector3d::Zero(), card);
  card->parameters.push_back({.name = "radius",
                              .meaning = "the support fades within this distance of the point "
                                         "(standard deviation), r; 0: it does not fade",
                              .dimension = kLength,
                              .bounds = kNotNegative,
                              .null_value = kNoNullValue,
                              .plausible_min = 0,
                              .plausible_max = 0.1,
                              .default_value = 0,
                              .setting = true,
                              .trial = {.share_of_length = 0.1}});
}

void BeddedPart::SetParameters(const Eigen::VectorXd& values) {
  CHECK_GT(values.size(), kSettings);
  if (settings_ == values.tail<kSettings>()) return;
  settings_ = values.tail<kSettings>();
  areas_.Forget();
}

std::shared_ptr<const Eigen::VectorXd> BeddedPart::Areas(const Body& body,
                                                         const std::string& type) const {
  return areas_.Of(body, [&](const Body& at_rest) {
    const Eigen::Vector3d point = settings_.head<3>();
    const double radius = settings_[kSettings - 1];
    Eigen::VectorXd areas = NodeBoundaryAreas(at_rest).cwiseProduct(
        InHalfSpace(point, settings_.segment<3>(3), at_rest));
    if (radius > 0) areas = areas.cwiseProduct(BumpAround(point, radius, at_rest));
    if (areas.sum() == 0) {
      throw InputError(fmt::format(
          "effect {}: no node of the body's surface lies on the side of its plane that `point` and "
          "`normal` name, or within its radius",
          type));
    }
    return areas;
  });
}

}  // namespace lacuna
