#include "trials/trial_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <variant>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/json_file.h"
#include "core/random_bits.h"
#include "diagnosis/nuisance_catalogue.h"
#include "effects/catalogue.h"
#include "effects/gravity.h"
#include "trials/case_files.h"

namespace lacuna {
namespace {

constexpr std::pair<TrialGroup, const char*> kGroups[] = {
    {TrialGroup::kControl, "control"},      {TrialGroup::kHardControl, "hard_control"},
    {TrialGroup::kOneEffect, "one_effect"}, {TrialGroup::kPair, "pair"},
    {TrialGroup::kRemoved, "removed"},      {TrialGroup::kIntervals, "intervals"}};

struct DrawnRange {
  double low, high;
};

// The objects and recordings from which cases are drawn: bars of soft rubber of the size of a
// finger, filmed at 100 frames per second. With another value the cases of all seeds are others, so
// that their diagnosis cannot be compared with earlier ones.
//
// Young's modulus, Pa, uniform in its logarithm: soft silicone rubbers.
constexpr DrawnRange kYoungModulus{6e4, 2e5};
// Poisson's ratio: nearly incompressible, but below the values at which linear tetrahedra lock.
constexpr DrawnRange kPoissonRatio{0.38, 0.46};
// Length and the two sides of the cross section, m: slender enough to bend far, thick enough for
// three-dimensional stresses.
constexpr DrawnRange kBarLength{0.07, 0.09}, kBarSide{0.016, 0.022};
// The largest error of each dimension of the model, relative: 0.16 mm of the length, as of a
// measurement with a calliper.
constexpr double kSizeError = 0.002;
// Length of the bar per deflection of its end by the hand: far enough that rotations matter.
constexpr double kLengthPerDeflection = 6;
// The force of the hand, relative to that which causes this deflection of a beam of Euler and
// Bernoulli.
constexpr DrawnRange kHoldForce{0.8, 1.2};
// The axial component of the force's direction is multiplied by this, since the bar is stiff along
// its axis: a force along it would hardly move it.
constexpr double kAxialShare = 0.3;
// The share of the first force's direction that is removed from that of the second one, so that
// they are not parallel. 1 would make them perpendicular.
constexpr double kRemovedParallelShare = 0.8;
// The time over which the noise of a marker is correlated, as a multiple of the time between
// frames.
constexpr DrawnRange kNoiseCorrelation{0.5, 1.5};
// The noise along the ray of a depth camera, m: four times that of a marker's coordinate.
constexpr double kTrialScanNoise = 4e-4;
// Stiffness-proportional damping, s, uniform in its logarithm.
constexpr DrawnRange kTrialDamping{3e-4, 1e-3};

// A load cell's noise, N, uniform in its logarithm, and the deviations of its offset, N, and of its
// delay, s. The bar weighs about 0.3 N, and the hand pulls with 0.1 N.
constexpr DrawnRange kLoadCellNoise{0.002, 0.02};
constexpr double kTareDeviation = 0.05;
constexpr double kDelayDeviation = 0.002;

// The place of a local effect along the bar, in lengths of the bar: not at the clamp, where it
// would have no influence on the motion.
constexpr DrawnRange kEffectPlace{0.25, 0.95};
// The distance of a contact plane from the bar at rest, in lengths of the bar. The bar's end swings
// by a sixth of the length, and so reaches the plane.
constexpr DrawnRange kPlaneGap{0.02, 0.08};
// Stiffness of a contact plane per Young's modulus, 1/m: stiff enough that the bar penetrates it by
// a small part of its thickness.
constexpr double kPlaneStiffness = 3e3;

// A stream of random numbers. Draw number n depends on the seed, the stream and n alone.
class Draws {
 public:
  Draws(uint64_t seed, uint64_t stream) : seed_(seed), stream_(stream) {}
  void SkipTo(uint64_t number) { count_ = number; }
  double In(const DrawnRange& range) {
    return range.low + (range.high - range.low) * Uniform(Next());
  }
  double LogIn(const DrawnRange& range) {
    return range.low * std::pow(range.high / range.low, Uniform(Next()));
  }
  double Sign() { return Next() % 2 == 0 ? 1 : -1; }
  Eigen::Vector3d Direction() {
    const Eigen::Vector3d v(Normal(Next()), Normal(Next()), Normal(Next()));
    return v.normalized();
  }

 private:
  uint64_t Next() { return RandomBits({seed_, stream_, count_++}); }
  uint64_t seed_, stream_, count_ = 0;
};

void SetVector(const std::string& name, const Eigen::Vector3d& vector,
               std::map<std::string, double>* values) {
  for (int axis = 0; axis < 3; ++axis)
    (*values)[fmt::format("{}_{}", name, "xyz"[axis])] = vector[axis];
}

// The streams of draws of a case, and the number of the first draw of an axis among those of a
// hidden effect. The numbers before it belong to the place (0) and to the cards' settings (1 to 5).
constexpr uint64_t kCaseStream = 1, kHiddenStream = 2, kLoadCellStream = 3;
constexpr uint64_t kAxisDraw = 6;

// Sets the parameter if its card says how trials choose it.
void DrawSetting(const ParameterCard& parameter, const TrialCase& trial, uint64_t seed,
                 std::map<std::string, double>* drawn) {
  const TrialSetting& setting = parameter.trial;
  if (setting.share_of_length > 0)
    (*drawn)[parameter.name] = setting.share_of_length * trial.size[0];
  if (!setting.IsDrawn()) return;
  Draws draws(seed, kHiddenStream);
  draws.SkipTo(static_cast<uint64_t>(setting.draw));
  (*drawn)[parameter.name] = parameter.log_scale ? draws.LogIn({setting.min, setting.max})
                                                 : draws.In({setting.min, setting.max});
}

// A plane beside the bar at the distance `gap` (m). A bar that is pulled to one side and released
// swings about as far to the other side, where the plane stands.
void PlacePlane(const TrialCase& trial, double gap, std::map<std::string, double>* drawn) {
  Eigen::Vector3d side = trial.hold_forces.front();
  side.x() = 0;
  side.normalize();
  const double half =
      0.5 * (std::abs(side.y()) * trial.size.y() + std::abs(side.z()) * trial.size.z());
  SetVector("normal", side, drawn);
  (*drawn)["stiffness"] = kPlaneStiffness * trial.young_modulus;  // Pa/m
  (*drawn)["offset"] = -half - gap;
}

// Throws InputError if the case was drawn for another card of the effect.
void RequireCard(const std::string& type, const std::map<std::string, double>& parameters,
                 const std::filesystem::path& file) {
  const CatalogueEntry* entry = FindEntry(type);
  for (const auto& [name, value] : parameters)
    if (entry == nullptr || ParameterIndex(*entry->card, name) < 0)
      throw InputError(fmt::format(
          "{}: contains {} with the parameter {}, which it does not have in this version of "
          "Lacuna; draw the suite again",
          file.string(), type, name));
}

nlohmann::json ToJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Vector3d VectorOf(const nlohmann::json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

}  // namespace

std::shared_ptr<const Effect> MakeHidden(const HiddenEffect& hidden) {
  return MakeEffect(hidden.type, hidden.parameters);
}

bool IsLaw(const HiddenEffect& hidden) {
  return FindEntry(hidden.type)->kind == CatalogueEntry::Kind::kMaterial;
}

std::string TrialGroupName(TrialGroup group) {
  for (const auto& [value, name] : kGroups)
    if (value == group) return name;
  return "";
}

TrialGroup TrialGroupFromName(const std::string& name) {
  for (const auto& [value, text] : kGroups)
    if (text == name) return value;
  throw InputError("\"" + name + "\" is not a group of sealed cases");
}

bool TrialCase::Hides(const std::string& type) const {
  return std::any_of(hidden.begin(), hidden.end(),
                     [&](const HiddenEffect& effect) { return effect.type == type; });
}

NuisanceTrial TrialCase::Disturbance() const {
  for (const NuisanceTrial& control : NuisanceControls())
    if (control.control == nuisance) return control;
  return {};
}

TrialCase DrawCase(const std::string& name, TrialGroup group, uint64_t seed, int recordings,
                   bool is_scanned, const std::string& nuisance) {
  TrialCase trial;
  trial.name = name;
  trial.group = group;
  trial.seed = seed;
  trial.recordings = recordings;
  trial.is_scanned = is_scanned;
  trial.nuisance = nuisance;
  Draws draws(seed, kCaseStream);
  trial.young_modulus = draws.LogIn(kYoungModulus);
  trial.poisson_ratio = draws.In(kPoissonRatio);
  trial.size = {draws.In(kBarLength), draws.In(kBarSide), draws.In(kBarSide)};
  for (int axis = 0; axis < 3; ++axis)
    trial.true_size[axis] = trial.size[axis] * (1 + kSizeError * draws.In({-1, 1}));
  const NuisanceTrial wrong = trial.Disturbance();
  // Always drawn, so that the later draws of a seed do not depend on the nuisance.
  const double edge = draws.In({wrong.least_clamp_error, wrong.largest_clamp_error}) * draws.Sign();
  if (wrong.largest_clamp_error > 0) trial.clamp_error = edge;
  const double inertia = trial.size[1] * std::pow(trial.size[2], 3) / 12;
  const double force = 3 * trial.young_modulus * inertia / std::pow(trial.size[0], 3) *
                       trial.size[0] / kLengthPerDeflection;
  for (int r = 0; r < 2; ++r) {
    Eigen::Vector3d direction = draws.Direction();
    direction.x() *= kAxialShare;
    direction.normalize();
    if (r == 1) {
      const Eigen::Vector3d first = trial.hold_forces[0].normalized();
      direction = (direction - kRemovedParallelShare * direction.dot(first) * first).normalized();
    }
    trial.hold_forces.emplace_back(force * draws.In(kHoldForce) * direction);
  }
  trial.hold_forces.resize(static_cast<size_t>(recordings));
  trial.noise_correlation_time = kTrialSpacing * draws.In(kNoiseCorrelation);
  if (is_scanned) {
    trial.noise = kTrialScanNoise;
    trial.noise_correlation_time = 0;
  }
  trial.damping = draws.LogIn(kTrialDamping);
  return trial;
}

std::optional<TrialLoadCell> DrawLoadCell(uint64_t seed, double share) {
  Draws draws(seed, kLoadCellStream);
  if (!(draws.In({0, 1}) < share)) return std::nullopt;
  return TrialLoadCell{.deviation = draws.LogIn(kLoadCellNoise),
                       .tare_deviation = kTareDeviation,
                       .delay_deviation = kDelayDeviation};
}

HiddenEffect DrawHidden(const std::string& type, const TrialCase& trial, uint64_t seed) {
  Draws draws(seed, kHiddenStream);
  HiddenEffect hidden;
  hidden.type = type;
  const EffectCard& card = *FindEntry(type)->card;
  const Eigen::Vector3d place(trial.size[0] * draws.In(kEffectPlace), 0, 0);
  std::map<std::string, double> drawn = {{"young_modulus", trial.young_modulus},
                                         {"poisson_ratio", trial.poisson_ratio}};
  for (const ParameterCard& parameter : card.parameters)
    DrawSetting(parameter, trial, seed, &drawn);
  SetVector(std::holds_alternative<TriedAsSupports>(card.tried_at) ? "point" : "centre", place,
            &drawn);
  SetVector("origin", Eigen::Vector3d(0.5 * trial.size[0], 0, 0), &drawn);
  draws.SkipTo(kAxisDraw);
  SetVector("axis", card.trial.axis_along_bar ? Eigen::Vector3d::UnitX() : draws.Direction(),
            &drawn);
  SetVector(kGravitySetting, {0, 0, -kStandardGravity}, &drawn);
  if (IsContact(card)) PlacePlane(trial, draws.In(kPlaneGap) * trial.size.x(), &drawn);
  const bool has_size = !IsLaw(hidden) && !IsContact(card);
  const bool is_vector = SizeParameters(card).size() == 3;
  const Eigen::Vector3d direction = draws.Direction();
  const double sign = draws.Sign();
  for (size_t k = 0; k < card.parameters.size(); ++k) {
    const ParameterCard& parameter = card.parameters[k];
    double value = parameter.default_value;
    const auto found = drawn.find(parameter.name);
    if (found != drawn.end()) value = found->second;
    if (has_size && k < (is_vector ? 3 : 1)) {
      hidden.amplitude.push_back(parameter.name);
      value = is_vector ? direction[static_cast<Eigen::Index>(k)]
                        : (parameter.bounds.min >= parameter.null_value ? 1 : sign);
    }
    hidden.parameters[parameter.name] = value;
  }
  return hidden;
}

std::string TextOfCase(const TrialCase& trial) {
  nlohmann::json hidden = nlohmann::json::array();
  for (const HiddenEffect& effect : trial.hidden)
    hidden.push_back({{"type", effect.type},
                      {"parameters", effect.parameters},
                      {"amplitude", effect.amplitude},
                      {"factor", effect.factor}});
  nlohmann::json forces = nlohmann::json::array();
  for (const Eigen::Vector3d& force : trial.hold_forces) forces.push_back(ToJson(force));
  nlohmann::json modelled = nlohmann::json::array();
  for (const ModelledEffect& effect : trial.modelled)
    modelled.push_back(
        {{"type", effect.type}, {"parameters", effect.parameters}, {"starts", effect.starts}});
  nlohmann::json all = {{"schema_version", 1},
                        {"name", trial.name},
                        {"group", TrialGroupName(trial.group)},
                        {"seed", trial.seed},
                        {"recordings", trial.recordings},
                        {"is_scanned", trial.is_scanned},
                        {"nuisance", trial.nuisance},
                        {"hidden", hidden},
                        {"modelled", modelled},
                        {"young_modulus", trial.young_modulus},
                        {"poisson_ratio", trial.poisson_ratio},
                        {"damping", trial.damping},
                        {"size", ToJson(trial.size)},
                        {"true_size", ToJson(trial.true_size)},
                        {"element_volume", trial.element_volume},
                        {"true_element_volume", trial.true_element_volume},
                        {"true_step", trial.true_step},
                        {"clamp_error", trial.clamp_error},
                        {"hold_forces", forces},
                        {"noise", trial.noise},
                        {"noise_correlation_time", trial.noise_correlation_time}};
  if (trial.load_cell)
    all["load_cell"] = {{"deviation", trial.load_cell->deviation},
                        {"tare_deviation", trial.load_cell->tare_deviation},
                        {"delay_deviation", trial.load_cell->delay_deviation}};
  return all.dump(2) + "\n";
}

void WriteCase(const TrialCase& trial, const std::filesystem::path& folder) {
  WriteFileAtomically(folder / kTruthFile, TextOfCase(trial));
}

TrialCase ReadCase(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kTruthFile;
  return ReadJsonFile(file, [&](const nlohmann::json& json) {
    TrialCase trial;
    trial.name = json.at("name");
    trial.group = NamingWhere(file.string(), [&] { return TrialGroupFromName(json.at("group")); });
    trial.seed = json.at("seed");
    trial.recordings = json.at("recordings");
    trial.is_scanned = json.value("is_scanned", false);
    trial.nuisance = json.at("nuisance");
    for (const auto& effect : json.at("hidden")) {
      trial.hidden.push_back({effect.at("type"), effect.at("parameters"), effect.at("amplitude"),
                              effect.at("factor")});
      RequireCard(trial.hidden.back().type, trial.hidden.back().parameters, file);
    }
    for (const auto& effect : json.value("modelled", nlohmann::json::array())) {
      trial.modelled.push_back({effect.at("type"), effect.at("parameters"), effect.at("starts")});
      RequireCard(trial.modelled.back().type, trial.modelled.back().parameters, file);
    }
    trial.young_modulus = json.at("young_modulus");
    trial.poisson_ratio = json.at("poisson_ratio");
    trial.damping = json.at("damping");
    trial.size = VectorOf(json.at("size"));
    trial.true_size = VectorOf(json.at("true_size"));
    trial.element_volume = json.value("element_volume", trial.element_volume);
    trial.true_element_volume = json.value("true_element_volume", trial.true_element_volume);
    trial.true_step = json.value("true_step", trial.true_step);
    trial.clamp_error = json.at("clamp_error");
    for (const auto& force : json.at("hold_forces")) trial.hold_forces.push_back(VectorOf(force));
    trial.noise = json.at("noise");
    trial.noise_correlation_time = json.at("noise_correlation_time");
    if (json.contains("load_cell")) {
      const auto& cell = json.at("load_cell");
      trial.load_cell = TrialLoadCell{cell.at("deviation"), cell.at("tare_deviation"),
                                      cell.at("delay_deviation")};
    }
    return trial;
  });
}

double Gauss(const TrialCase& trial, uint64_t stream, uint64_t i, uint64_t j) {
  return Normal(RandomBits({trial.seed, stream, i, j}));
}

}  // namespace lacuna
