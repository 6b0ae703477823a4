#include "diagnosis/candidates.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <variant>

#include "diagnosis/support_sides.h"
#include "effects/catalogue.h"
#include "effects/gravity.h"
#include "geometry/farthest_first.h"
#include "record/effect_card.h"

namespace lacuna {
namespace {

using Values = std::map<std::string, double>;

struct Variant {
  std::string name;
  Values values;
  VariantPosition position = {};
  std::map<std::string, CandidateEffect::Range> known = {};  // besides PlacesOn(body)
};

// The principal extents of the body.
struct Extent {
  Eigen::Vector3d centre;
  Eigen::Matrix3d axis;    // columns: principal axes, the longest first; their largest component is
                           // positive
  Eigen::Vector3d length;  // m, along the axes
  // Of a body that is not a bar: the centres of parts of about equal volume, and the distance below
  // which two of them are neighbours, m. Empty for a bar, whose places lie along its length.
  Eigen::Matrix3Xd places;
  double spacing = 0;
};

// Centres of parts of about equal volume, each moved to the nearest quadrature point so that it
// lies in the body (S. P. Lloyd, IEEE Trans. Inf. Theory 28, 1982).
Eigen::Matrix3Xd EvenPlaces(const Body& body, const Eigen::Vector3d& first, int most) {
  constexpr int kRounds = 30;
  const int count = std::min(most, static_cast<int>(body.point.cols()));
  const auto nearest_to = [&](const Eigen::Vector3d& place) {
    Eigen::Index nearest;
    (body.point.colwise() - place).colwise().squaredNorm().minCoeff(&nearest);
    return nearest;
  };
  Eigen::Matrix3Xd places = body.point(
      Eigen::all, FarthestFirst(static_cast<int>(body.point.cols()),
                                static_cast<int>(nearest_to(first)), count, [&](int a, int b) {
                                  return (body.point.col(a) - body.point.col(b)).squaredNorm();
                                }));
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, count);
    Eigen::VectorXd volume = Eigen::VectorXd::Zero(count);
    for (Eigen::Index q = 0; q < body.point.cols(); ++q) {
      const Eigen::Vector3d point = body.point.col(q);
      Eigen::Index part;
      (places.colwise() - point).colwise().squaredNorm().minCoeff(&part);
      sum.col(part) += body.weight[q] * point;
      volume[part] += body.weight[q];
    }
    for (int k = 0; k < count; ++k)
      if (volume[k] > 0) places.col(k) = sum.col(k) / volume[k];
  }
  for (int k = 0; k < count; ++k) places.col(k) = body.point.col(nearest_to(places.col(k))).eval();
  return places;
}

Extent Measure(const Body& body) {
  Extent extent;
  const Eigen::VectorXd& mass = body.node_mass;
  extent.centre = body.mesh.nodes * mass / mass.sum();
  const Eigen::Matrix3Xd from = body.mesh.nodes.colwise() - extent.centre;
  const Eigen::Matrix3d inertia = from * mass.asDiagonal() * from.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(inertia);
  // Equal moments leave the axes undetermined, as those of a square or round section. They are then
  // chosen close to the coordinate axes.
  constexpr double kDistinct = 1.1;
  const Eigen::Vector3d moment = eigen.eigenvalues();
  Eigen::Vector3d longest = eigen.eigenvectors().col(2);
  if (moment[2] < kDistinct * moment[1]) longest = Eigen::Vector3d::UnitX();
  Eigen::Vector3d second = eigen.eigenvectors().col(1);
  if (moment[1] < kDistinct * moment[0] || moment[2] < kDistinct * moment[1]) {
    Eigen::Index least;
    longest.cwiseAbs().minCoeff(&least);
    second = Eigen::Vector3d::Unit(least);
    second = (second - longest.dot(second) * longest).normalized();
  }
  extent.axis << longest, second, longest.cross(second);
  for (int k = 0; k < 3; ++k) {
    Eigen::Vector3d axis = extent.axis.col(k);
    Eigen::Index largest;
    axis.cwiseAbs().maxCoeff(&largest);
    if (axis[largest] < 0) axis = -axis;
    extent.axis.col(k) = axis;
    const Eigen::RowVectorXd along = axis.transpose() * from;
    extent.length[k] = along.maxCoeff() - along.minCoeff();
  }
  // A body whose width exceeds this share of its length is not a bar.
  constexpr double kBar = 0.4;
  constexpr int kPlaces = 16;
  if (extent.length[1] > kBar * extent.length[0]) {
    extent.places = EvenPlaces(body, extent.centre, kPlaces);
    constexpr double kNear = 1.5;  // distance of adjacent parts, in their width
    extent.spacing = kNear * std::cbrt(body.weight.sum() / kPlaces);
  }
  return extent;
}

void SetVector(const std::string& name, const Eigen::Vector3d& vector, Values* values) {
  (*values)[name + "_x"] = vector.x();
  (*values)[name + "_y"] = vector.y();
  (*values)[name + "_z"] = vector.z();
}

std::string AxisName(const Eigen::Vector3d& axis) {
  return fmt::format("along ({:.2g}, {:.2g}, {:.2g})", axis.x() + 0.0, axis.y() + 0.0,
                     axis.z() + 0.0);
}

Variant AtPlace(const Eigen::Vector3d& place, double radius, std::string name) {
  Variant variant;
  variant.name = std::move(name);
  for (const char* of : {"centre", "point"}) SetVector(of, place, &variant.values);
  variant.values["radius"] = radius;
  return variant;
}

// Places on the longest axis, at these shares of its length.
std::vector<Variant> PlacesAlong(const Extent& extent, const std::vector<double>& shares,
                                 double radius_share) {
  std::vector<Variant> variants;
  for (const double share : shares) {
    variants.push_back(AtPlace(
        extent.centre + (share - 0.5) * extent.length[0] * extent.axis.col(0),
        radius_share * extent.length[0], fmt::format("at {:.0f} % of the length", 100 * share)));
    variants.back().position = {.line = 1, .number = static_cast<int>(variants.size())};
  }
  return variants;
}

// Places along a bar, at these shares of its length, or throughout any other body.
std::vector<Variant> Places(const Extent& extent, const std::vector<double>& shares,
                            double radius_share) {
  if (extent.places.cols() == 0) return PlacesAlong(extent, shares, radius_share);
  std::vector<Variant> variants;
  for (Eigen::Index k = 0; k < extent.places.cols(); ++k) {
    const Eigen::Vector3d place = extent.places.col(k);
    variants.push_back(AtPlace(place, radius_share * extent.length[0],
                               fmt::format("at ({:.0f}, {:.0f}, {:.0f}) mm", 1e3 * place.x() + 0.0,
                                           1e3 * place.y() + 0.0, 1e3 * place.z() + 0.0)));
    variants.back().position = {.place = place, .spacing = extent.spacing};
  }
  return variants;
}

Variant AlongDirection(const Eigen::Vector3d& axis) {
  Variant variant;
  variant.name = AxisName(axis);
  SetVector("axis", axis, &variant.values);
  variant.values["azimuth"] = std::atan2(axis.y(), axis.x());
  variant.values["inclination"] = std::asin(std::clamp(axis.z(), -1.0, 1.0));
  return variant;
}

// Gradients along the length, and along the width of a body that is not a bar.
std::vector<Variant> Gradients(const Extent& extent) {
  std::vector<Variant> variants;
  for (int axis = 0; axis < (extent.places.cols() > 0 ? 2 : 1); ++axis) {
    variants.push_back(AlongDirection(extent.axis.col(axis)));
    SetVector("origin", extent.centre, &variants.back().values);
    variants.back().values["length"] = extent.length[axis];
  }
  return variants;
}

// The principal axes and the diagonals between two and three of them: any direction is within 28°
// of one of these.
std::vector<Variant> Directions(const Extent& extent) {
  std::vector<Variant> variants;
  for (int code = 1; code < 27; ++code) {
    const Eigen::Vector3d steps((code + 1) % 3 - 1, (code / 3 + 1) % 3 - 1, (code / 9 + 1) % 3 - 1);
    // Of two opposite directions one is kept: the one whose last non-zero step is positive.
    const double last = steps[2] != 0 ? steps[2] : steps[1] != 0 ? steps[1] : steps[0];
    if (last <= 0) continue;
    const Eigen::Vector3d axis = (extent.axis * steps).normalized();
    variants.push_back(AlongDirection(axis));
    variants.back().position.axis = axis;
  }
  return variants;
}

std::vector<Variant> AtValues(const ParameterCard& parameter, const std::string& label,
                              const std::vector<double>& values) {
  const std::string unit = parameter.dimension.unit;
  std::vector<Variant> variants;
  for (const double value : values)
    variants.push_back({fmt::format("{} = {:.2g}{}{}", label, value, unit.empty() ? "" : " ", unit),
                        {{parameter.name, value}},
                        {.line = 1, .number = static_cast<int>(variants.size())}});
  return variants;
}

// Supports have a place that a refit may move in the coordinates `along` only, each within its
// range (m), and a radius that it may change by this factor.
constexpr double kRadiusFactor = 4;

Variant WithMovablePlace(Variant variant, const std::map<int, CandidateEffect::Range>& along) {
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
std::vector<Variant> SupportsOfGirth(const Extent& extent, const Body& body) {
  constexpr double kAlong = 0.95;  // of the cosine between the length and the coordinate axis
  std::map<int, CandidateEffect::Range> along;
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(extent.axis(axis, 0)) > kAlong) along[axis] = ExtentAlong(body, axis);
  std::vector<Variant> variants = {WithMovablePlace({"of the whole surface", {}}, {})};
  for (const Variant& variant : PlacesAlong(extent, {0.05, 0.5, 0.95}, 0.1))
    variants.push_back(WithMovablePlace(variant, along));
  return variants;
}

Variant OnWholeSide(const BodySide& side) {
  Variant variant{fmt::format("on the {} side", side.name), {}};
  SetVector("side", side.normal, &variant.values);
  return WithMovablePlace(variant, {});
}

// Places along a side, each with a radius that covers about a third of it. The place can be moved
// along the side, and across it where it is not a narrow strip.
std::vector<Variant> PlacesAlong(const BodySide& side, const Body& body, int line) {
  constexpr double kShares[] = {1.0 / 6, 0.5, 5.0 / 6};
  constexpr double kRadiusShare = 1.0 / 6;
  constexpr double kStrip = 0.4;  // width over length
  std::map<int, CandidateEffect::Range> along;
  along[side.longer] = {side.low[side.longer], side.high[side.longer]};
  if (side.Width() > kStrip * side.Length())
    along[side.shorter] = {side.low[side.shorter], side.high[side.shorter]};
  const double radius = kRadiusShare * side.Length();
  std::vector<Variant> variants;
  for (const double share : kShares) {
    const double at = side.low[side.longer] + share * side.Length();
    Variant variant;
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

std::vector<Variant> Supports(const Extent& extent, const CandidateSetting& setting) {
  constexpr double kLong = 0.5;  // length of a long side over that of the body
  std::vector<Variant> variants = SupportsOfGirth(extent, setting.body);
  int line = 1;  // that of the girth
  for (const BodySide& side : SidesOf(setting.body, setting.gripped)) {
    variants.push_back(OnWholeSide(side));
    if (side.Length() < kLong * extent.length[0]) continue;
    const std::vector<Variant> places = PlacesAlong(side, setting.body, ++line);
    variants.insert(variants.end(), places.begin(), places.end());
  }
  return variants;
}

std::vector<Variant> SlippingSupports(const Extent& extent, const CandidateSetting& setting,
                                      const std::vector<double>& slip_shares) {
  std::vector<Variant> at_once = SupportsOfGirth(extent, setting.body);
  for (const BodySide& side : SidesOf(setting.body, setting.gripped))
    at_once.push_back(OnWholeSide(side));
  std::vector<Variant> variants;
  int line = 0;
  for (const double share : slip_shares) {
    ++line;
    const double distance = share * extent.length[0];
    for (Variant variant : at_once) {
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
  VariantsOf(const EffectCard& card, const Extent& extent, const CandidateSetting& setting)
      : card_(card), extent_(extent), setting_(setting) {}

  std::vector<Variant> operator()(const TriedOnce&) const { return {{"", {}}}; }
  std::vector<Variant> operator()(const TriedAtPlaces& places) const {
    return Places(extent_, places.length_shares, places.radius_share);
  }
  std::vector<Variant> operator()(const TriedAlongDirections&) const { return Directions(extent_); }
  std::vector<Variant> operator()(const TriedAsGradients&) const { return Gradients(extent_); }
  std::vector<Variant> operator()(const TriedAtValues& values) const {
    return AtValues(ParameterOf(card_, values.parameter), values.label, values.values);
  }
  std::vector<Variant> operator()(const TriedAtRelaxationTimes& times) const {
    return AtValues(ParameterOf(card_, times.parameter), times.label, RelaxationTimes(setting_));
  }
  std::vector<Variant> operator()(const TriedAsSupports& supports) const {
    return supports.slip_shares.empty() ? Supports(extent_, setting_)
                                        : SlippingSupports(extent_, setting_, supports.slip_shares);
  }
  std::vector<Variant> operator()(const TriedAtContactPlanes&) const { return {}; }

 private:
  const EffectCard& card_;
  const Extent& extent_;
  const CandidateSetting& setting_;
};

// The coordinates that a place on the body may have.
std::map<std::string, CandidateEffect::Range> PlacesOn(const Body& body) {
  std::map<std::string, CandidateEffect::Range> ranges;
  for (int axis = 0; axis < 3; ++axis)
    ranges[fmt::format("centre_{}", "xyz"[axis])] = ExtentAlong(body, axis);
  return ranges;
}

// The parameters of the card: from the variant, else from the model, else the default value (NaN if
// there is none). The size of the effect is zero.
Eigen::VectorXd ValuesOf(const EffectCard& card, const Variant& variant,
                         const CandidateSetting& setting) {
  Values known = variant.values;
  SetVector(kGravitySetting, GravityOf(setting.effects).value_or(Eigen::Vector3d::Zero()), &known);
  const Effect& material = *setting.effects.front();
  for (size_t m = 0; m < material.Card().parameters.size(); ++m)
    known.try_emplace(material.Card().parameters[m].name,
                      material.Parameters()[static_cast<Eigen::Index>(m)]);
  Eigen::VectorXd values(card.parameters.size());
  for (size_t k = 0; k < card.parameters.size(); ++k) {
    const auto found = known.find(card.parameters[k].name);
    values[static_cast<Eigen::Index>(k)] =
        found != known.end() ? found->second : card.parameters[k].default_value;
  }
  for (const int k : SizeParameters(card)) values[k] = card.parameters[k].null_value;
  return values;
}

}  // namespace

bool AreNeighbours(const VariantPosition& a, const VariantPosition& b) {
  // Among the principal axes and their diagonals, an axis and the diagonals next to it.
  constexpr double kNeighbourAngle = 1;  // rad
  const bool in_line = a.line > 0 && a.line == b.line && std::abs(a.number - b.number) == 1;
  const bool is_near =
      a.spacing > 0 && b.spacing > 0 && (a.place - b.place).norm() < std::min(a.spacing, b.spacing);
  return in_line || is_near || std::abs(a.axis.dot(b.axis)) > std::cos(kNeighbourAngle);
}

double PlausibleScale(const ParameterCard& card) {
  return std::max(std::abs(card.plausible_min), std::abs(card.plausible_max));
}

std::vector<CandidateAmount> AmountsOf(const CandidateEffect& candidate) {
  if (candidate.IsPilot()) return {{"share", "", 1, true}};
  std::vector<CandidateAmount> amounts;
  for (const int index : candidate.amplitude) {
    const ParameterCard& parameter = candidate.effect->Card().parameters[index];
    amounts.push_back({parameter.name, parameter.dimension.unit, PlausibleScale(parameter),
                       parameter.bounds.min >= parameter.null_value});
  }
  return amounts;
}

std::vector<CandidateEffect> MakeCandidates(const CandidateSetting& setting) {
  const Extent extent = Measure(setting.body);
  std::vector<CandidateEffect> candidates;
  for (const CatalogueEntry& entry : Catalogue()) {
    const EffectCard& card = *entry.card;
    if (entry.kind != CatalogueEntry::Kind::kEffect || entry.make == nullptr) continue;
    if (card.parameters.empty() || std::isnan(card.parameters[0].null_value)) continue;
    if (std::count(setting.without.begin(), setting.without.end(), card.type) > 0) continue;
    const bool present =
        std::any_of(setting.effects.begin(), setting.effects.end(),
                    [&](const auto& effect) { return effect->Card().type == card.type; });
    if (present && !card.repeatable) continue;
    for (const Variant& variant : std::visit(VariantsOf(card, extent, setting), card.tried_at)) {
      const Eigen::VectorXd values = ValuesOf(card, variant, setting);
      CHECK(values.allFinite()) << card.type << " has a parameter without a value";
      candidates.push_back({card.type, variant.name, entry.make(values), SizeParameters(card)});
      candidates.back().position = variant.position;
      candidates.back().known = variant.known;
      candidates.back().known.merge(PlacesOn(setting.body));
    }
  }
  for (const OwnLaw& law : setting.laws) {
    if (std::count(setting.without.begin(), setting.without.end(), law.name) > 0) continue;
    Eigen::VectorXd values = law.effect->Parameters();
    values[0] = law.effect->Card().parameters[0].null_value;
    candidates.push_back({law.name, "", law.effect->WithParameters(values), {0}});
  }
  return candidates;
}

}  // namespace lacuna
