#include "diagnosis/candidate_variants.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "diagnosis/support_sides.h"

namespace lacuna {
namespace {

void SetVector(const std::string& name, const Eigen::Vector3d& vector,
               std::map<std::string, double>* values) {
  (*values)[name + "_x"] = vector.x();
  (*values)[name + "_y"] = vector.y();
  (*values)[name + "_z"] = vector.z();
}

std::string AxisName(const Eigen::Vector3d& axis) {
  return fmt::format("along ({:.2g}, {:.2g}, {:.2g})", axis.x() + 0.0, axis.y() + 0.0,
                     axis.z() + 0.0);
}

CandidateVariant AtPlace(const Eigen::Vector3d& place, double radius, std::string name) {
  CandidateVariant variant;
  variant.name = std::move(name);
  for (const char* of : {"centre", "point"}) SetVector(of, place, &variant.values);
  variant.values["radius"] = radius;
  return variant;
}

// Places on the longest axis, at these shares of its length.
std::vector<CandidateVariant> PlacesAlong(const BodyExtent& extent,
                                          const std::vector<double>& shares, double radius_share) {
  std::vector<CandidateVariant> variants;
  for (const double share : shares) {
    variants.push_back(AtPlace(
        extent.centre + (share - 0.5) * extent.length[0] * extent.axis.col(0),
        radius_share * extent.length[0], fmt::format("at {:.0f} % of the length", 100 * share)));
    variants.back().position = {.line = 1, .number = static_cast<int>(variants.size())};
  }
  return variants;
}

// Places along a bar, at these shares of its length, or throughout any other body.
std::vector<CandidateVariant> Places(const BodyExtent& extent, const std::vector<double>& shares,
                                     double radius_share) {
  if (extent.IsBar()) return PlacesAlong(extent, shares, radius_share);
  std::vector<CandidateVariant> variants;
  for (Eigen::Index k = 0; k < extent.places.cols(); ++k) {
    const Eigen::Vector3d place = extent.places.col(k);
    variants.push_back(AtPlace(place, radius_share * extent.length[0],
                               fmt::format("at ({:.0f}, {:.0f}, {:.0f}) mm", 1e3 * place.x() + 0.0,
                                           1e3 * place.y() + 0.0, 1e3 * place.z() + 0.0)));
    variants.back().position = {.place = place, .spacing = extent.spacing};
  }
  return variants;
}

CandidateVariant AlongDirection(const Eigen::Vector3d& axis) {
  CandidateVariant variant;
  variant.name = AxisName(axis);
  SetVector("axis", axis, &variant.values);
  variant.values["azimuth"] = std::atan2(axis.y(), axis.x());
  variant.values["inclination"] = std::asin(std::clamp(axis.z(), -1.0, 1.0));
  return variant;
}

// Gradients along the length, and along the width of a body that is not a bar.
std::vector<CandidateVariant> Gradients(const BodyExtent& extent) {
  std::vector<CandidateVariant> variants;
  for (int axis = 0; axis < (extent.IsBar() ? 1 : 2); ++axis) {
    variants.push_back(AlongDirection(extent.axis.col(axis)));
    SetVector("origin", extent.centre, &variants.back().values);
    variants.back().values["length"] = extent.length[axis];
  }
  return variants;
}

// The principal axes and the diagonals between two and three of them: any direction is within 28°
// of one of these.
std::vector<CandidateVariant> Directions(const BodyExtent& extent) {
  std::vector<CandidateVariant> variants;
  for (int code = 1; code < 27; ++code) {
    const Eigen::Vector3d steps((code + 1) % 3 - 1, (code / 3 + 1) % 3 - 1, (code / 9 + 1) % 3 - 1);
    // One of two opposite directions is kept: the one whose last non-zero step is positive.
    const double last = steps[2] != 0 ? steps[2] : steps[1] != 0 ? steps[1] : steps[0];
    if (last <= 0) continue;
    const Eigen::Vector3d axis = (extent.axis * steps).normalized();
    variants.push_back(AlongDirection(axis));
    variants.back().position.axis = axis;
  }
  return variants;
}

std::vector<CandidateVariant> AtValues(const ParameterCard& parameter, const std::string& label,
                                       const std::vector<double>& values) {
  const std::string unit = parameter.dimension.unit;
  std::vector<CandidateVariant> variants;
  for (const double value : values)
    variants.push_back({fmt::format("{} = {:.2g}{}{}", label, value, unit.empty() ? "" : " ", unit),
                        {{parameter.name, value}},
                        {.line = 1, .number = static_cast<int>(variants.size())}});
  return variants;
}

// Supports have a place that a refit may move in the coordinates `along` only, each within its
// range (m), and a radius that it may change by this factor.
constexpr double kRadiusFactor = 4;

CandidateVariant WithMovablePlace(CandidateVariant variant,
                                  const std::map<int, CandidateEffect::Range>& along) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = fmt::format("point_{}", "xyz"[axis]);
    const auto found = variant.values.find(name);
    const double at = found != variant.values.end() ? found->second : 0;
    const auto range = along.find(axis);
    variant.known[name] = range != along.end() ? range->second : CandidateEffect::Range{at, at};
  }
  const auto radius = variant.values.find("radius");
  variant.known["radius"] =
      radius != variant.values.end()
          ? CandidateEffect::Range{radius->second / kRadiusFactor, radius->second * kRadiusFactor}
          : CandidateEffect::Range{0, 0};
  return variant;
}

CandidateEffect::Range ExtentAlong(const Body& body, int axis) {
  const Eigen::RowVectorXd along = body.mesh.nodes.row(axis);
  return {along.minCoeff(), along.maxCoeff()};
}

// The whole surface, and around the girth near both ends and at the middle of the length. The place
// of these can be moved if the length lies along a coordinate axis.
std::vector<CandidateVariant> SupportsOfGirth(const BodyExtent& extent, const Body& body) {
  constexpr double kAlong = 0.95;  // of the cosine between the length and the coordinate axis
  std::map<int, CandidateEffect::Range> along;
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(extent.axis(axis, 0)) > kAlong) along[axis] = ExtentAlong(body, axis);
  std::vector<CandidateVariant> variants = {WithMovablePlace({"of the whole surface", {}}, {})};
  for (const CandidateVariant& variant : PlacesAlong(extent, {0.05, 0.5, 0.95}, 0.1))
    variants.push_back(WithMovablePlace(variant, along));
  return variants;
}

CandidateVariant OnWholeSide(const BodySide& side) {
  CandidateVariant variant{fmt::format("on the {} side", side.name), {}};
  SetVector("side", side.normal, &variant.values);
  return WithMovablePlace(variant, {});
}

// Places along a side, each with a radius that covers about a third of it. The place can be moved
// along the side, and across it where it is not a narrow strip.
std::vector<CandidateVariant> PlacesOnSide(const BodySide& side, const Body& body, int line) {
  constexpr double kShares[] = {1.0 / 6, 0.5, 5.0 / 6};
  constexpr double kRadiusShare = 1.0 / 6;
  constexpr double kStrip = 0.4;  // width over length
  std::map<int, CandidateEffect::Range> along;
  along[side.longer] = {side.low[side.longer], side.high[side.longer]};
  if (side.Width() > kStrip * side.Length())
    along[side.shorter] = {side.low[side.shorter], side.high[side.shorter]};
  const double radius = kRadiusShare * side.Length();
  std::vector<CandidateVariant> variants;
  for (const double share : kShares) {
    const double at = side.low[side.longer] + share * side.Length();
    CandidateVariant variant;
    variant.name = fmt::format("on the {} side at {} = {:.0f} mm", side.name, "xyz"[side.longer],
                               1e3 * at + 0.0);
    SetVector("side", side.normal, &variant.values);
    SetVector("point", PlaceOn(side, at, radius, body), &variant.values);
    variant.values["radius"] = radius;
    variant.position = {.line = line, .number = static_cast<int>(variants.size())};
    variants.push_back(WithMovablePlace(variant, along));
  }
  return variants;
}

std::vector<CandidateVariant> Supports(const BodyExtent& extent, const CandidateSetting& setting) {
  constexpr double kLong = 0.5;  // length of a long side over that of the body
  std::vector<CandidateVariant> variants = SupportsOfGirth(extent, setting.body);
  int line = 1;  // that of the girth
  for (const BodySide& side : SidesOf(setting.body, setting.gripped)) {
    variants.push_back(OnWholeSide(side));
    if (side.Length() < kLong * extent.length[0]) continue;
    const std::vector<CandidateVariant> places = PlacesOnSide(side, setting.body, ++line);
    variants.insert(variants.end(), places.begin(), places.end());
  }
  return variants;
}

std::vector<CandidateVariant> SlippingSupports(const BodyExtent& extent,
                                               const CandidateSetting& setting,
                                               const std::vector<double>& slip_shares) {
  std::vector<CandidateVariant> at_once = SupportsOfGirth(extent, setting.body);
  for (const BodySide& side : SidesOf(setting.body, setting.gripped))
    at_once.push_back(OnWholeSide(side));
  std::vector<CandidateVariant> variants;
  int line = 0;
  for (const double share : slip_shares) {
    ++line;
    const double distance = share * extent.length[0];
    for (CandidateVariant variant : at_once) {
      variant.name += fmt::format(", sliding at {:.2g} mm", 1e3 * distance);
      variant.values["slip_distance"] = distance;
      if (variant.position.line > 0) variant.position.line = line;
      variants.push_back(std::move(variant));
    }
  }
  return variants;
}

std::vector<double> RelaxationTimes(const CandidateSetting& setting) {
  std::vector<double> times;
  for (double time = std::max(4 * setting.time_step, 0.003 * setting.duration);
       time <= setting.duration; time *= 4)
    times.push_back(time);
  if (times.empty()) times.push_back(setting.duration);
  return times;
}

const ParameterCard& ParameterOf(const EffectCard& card, const std::string& name) {
  const int index = ParameterIndex(card, name);
  CHECK_GE(index, 0) << card.type << " is tried at values of " << name
                     << ", which it does not have";
  return card.parameters[index];
}

// The variants that `tried_at` of a card asks for.
class VariantsOf {
 public:
  VariantsOf(const EffectCard& card, const BodyExtent& extent, const CandidateSetting& setting)
      : card_(card), extent_(extent), setting_(setting) {}

  std::vector<CandidateVariant> operator()(const TriedOnce&) const { return {{"", {}}}; }
  std::vector<CandidateVariant> operator()(const TriedAtPlaces& places) const {
    return Places(extent_, places.length_shares, places.radius_share);
  }
  std::vector<CandidateVariant> operator()(const TriedAlongDirections&) const {
    return Directions(extent_);
  }
  std::vector<CandidateVariant> operator()(const TriedAsGradients&) const {
    return Gradients(extent_);
  }
  std::vector<CandidateVariant> operator()(const TriedAtValues& values) const {
    return AtValues(ParameterOf(card_, values.parameter), values.label, values.values);
  }
  std::vector<CandidateVariant> operator()(const TriedAtRelaxationTimes& times) const {
    return AtValues(ParameterOf(card_, times.parameter), times.label, RelaxationTimes(setting_));
  }
  std::vector<CandidateVariant> operator()(const TriedAsSupports& supports) const {
    return supports.slip_shares.empty() ? Supports(extent_, setting_)
                                        : SlippingSupports(extent_, setting_, supports.slip_shares);
  }
  std::vector<CandidateVariant> operator()(const TriedAtContactPlanes&) const { return {}; }

 private:
  const EffectCard& card_;
  const BodyExtent& extent_;
  const CandidateSetting& setting_;
};

// The coordinates that a place on the body may have.
std::map<std::string, CandidateEffect::Range> PlacesOn(const Body& body) {
  std::map<std::string, CandidateEffect::Range> ranges;
  for (int axis = 0; axis < 3; ++axis)
    ranges[fmt::format("centre_{}", "xyz"[axis])] = ExtentAlong(body, axis);
  return ranges;
}

}  // namespace

std::vector<CandidateVariant> VariantsFor(const EffectCard& card, const BodyExtent& extent,
                                          const CandidateSetting& setting) {
  std::vector<CandidateVariant> variants =
      std::visit(VariantsOf(card, extent, setting), card.tried_at);
  for (CandidateVariant& variant : variants) variant.known.merge(PlacesOn(setting.body));
  return variants;
}

}  // namespace lacuna
