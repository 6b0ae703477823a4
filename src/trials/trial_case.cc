#include "trials/trial_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "diagnosis/candidates.h"
#include "diagnosis/nuisance_catalogue.h"
#include "effects/catalogue.h"
#include "scan/random_bits.h"

namespace lacuna {
namespace {

// A stream of draws.
class Draws {
 public:
  Draws(uint64_t seed, uint64_t stream) : seed_(seed), stream_(stream) {}
  double Between(double low, double high) { return low + (high - low) * Uniform(Next()); }
  double LogBetween(double low, double high) { return low * std::pow(high / low, Uniform(Next())); }
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

bool IsKnown(const std::string& type) { return type == "gravity" || type == "stiffness_damping"; }

bool TrialCase::Hides(const std::string& type) const {
  return std::any_of(hidden.begin(), hidden.end(),
                     [&](const HiddenEffect& effect) { return effect.type == type; });
}

NuisanceTrial TrialCase::Disturbance() const {
  for (const NuisanceTrial& control : NuisanceControls())
    if (control.control == nuisance) return control;
  return {};
}

TrialCase DrawCase(const std::string& name, const std::string& group, uint64_t seed, int recordings,
                   bool is_scanned, const std::string& nuisance) {
  TrialCase trial;
  trial.name = name;
  trial.group = group;
  trial.seed = seed;
  trial.recordings = recordings;
  trial.is_scanned = is_scanned;
  trial.nuisance = nuisance;
  Draws draws(seed, 1);
  trial.young_modulus = draws.LogBetween(6e4, 2e5);
  trial.poisson_ratio = draws.Between(0.38, 0.46);
  trial.size = {draws.Between(0.07, 0.09), draws.Between(0.016, 0.022),
                draws.Between(0.016, 0.022)};
  for (int axis = 0; axis < 3; ++axis)
    trial.true_size[axis] = trial.size[axis] * (1 + 0.002 * draws.Between(-1, 1));
  const NuisanceTrial wrong = trial.Disturbance();
  // Drawn in any case, so that the further draws of a seed are the same with and without it.
  const double edge =
      draws.Between(wrong.least_clamp_error, wrong.largest_clamp_error) * draws.Sign();
  if (wrong.largest_clamp_error > 0) trial.clamp_error = edge;
  // A force that bends the bar by about a sixth of its length.
  const double inertia = trial.size[1] * std::pow(trial.size[2], 3) / 12;
  const double force =
      3 * trial.young_modulus * inertia / std::pow(trial.size[0], 3) * trial.size[0] / 6;
  for (int r = 0; r < 2; ++r) {
    Eigen::Vector3d direction = draws.Direction();
    direction.x() *= 0.3;
    direction.normalize();
    if (r == 1) {
      // Not along the first one.
      const Eigen::Vector3d first = trial.hold_forces[0].normalized();
      direction = (direction - 0.8 * direction.dot(first) * first).normalized();
    }
    trial.hold_forces.emplace_back(force * draws.Between(0.8, 1.2) * direction);
  }
  trial.hold_forces.resize(static_cast<size_t>(recordings));
  trial.noise_correlation_time = 0.01 * draws.Between(0.5, 1.5);
  if (is_scanned) {
    trial.noise = 4e-4;
    trial.noise_correlation_time = 0;
  }
  trial.damping = draws.LogBetween(3e-4, 1e-3);
  return trial;
}

HiddenEffect DrawHidden(const std::string& type, const TrialCase& trial, uint64_t seed) {
  Draws draws(seed, 2);
  HiddenEffect hidden;
  hidden.type = type;
  const EffectCard& card = *FindEntry(type)->card;
  const Eigen::Vector3d place(trial.size[0] * draws.Between(0.25, 0.95), 0, 0);
  std::map<std::string, double> drawn = {
      {"young_modulus", trial.young_modulus},
      {"poisson_ratio", trial.poisson_ratio},
      {"relaxation_time", draws.LogBetween(0.02, 0.3)},
      {"yield_strain", draws.LogBetween(0.005, 0.03)},
      {"softening_strain", draws.LogBetween(0.03, 0.2)},
      {"azimuth", draws.Between(-1.2, 1.2)},
      {"inclination", draws.Between(-1.2, 1.2)},
      {"length", trial.size[0]},
      {"radius", type == "inclusion" ? 0.15 * trial.size[0] : 0.005}};
  SetVector("centre", place, &drawn);
  SetVector("origin", Eigen::Vector3d(0.5 * trial.size[0], 0, 0), &drawn);
  const bool along = type == "active_contraction" || type.ends_with("gradient");
  SetVector("axis", along ? Eigen::Vector3d::UnitX() : draws.Direction(), &drawn);
  SetVector("gravity", {0, 0, -9.80665}, &drawn);
  if (type == "plane_contact") {
    // A bar that is pulled to one side and let go swings to the other, about as far.
    Eigen::Vector3d side = trial.hold_forces.front();
    side.x() = 0;
    side.normalize();
    const double half =
        0.5 * (std::abs(side.y()) * trial.size.y() + std::abs(side.z()) * trial.size.z());
    const double gap = draws.Between(0.02, 0.08) * trial.size.x();
    SetVector("normal", side, &drawn);
    drawn["stiffness"] = 3e3 * trial.young_modulus;  // Pa/m
    drawn["offset"] = -half - gap;
  }
  if (type == "elastic_support" || type == "slipping_support") {
    SetVector("point", place, &drawn);
    drawn["radius"] = 0.1 * trial.size[0];
    drawn["slip_distance"] = draws.LogBetween(2e-4, 2e-3);
  }
  const bool has_size = !IsLaw(hidden) && type != "plane_contact";
  const bool is_vector = card.parameters[0].name.ends_with("_x");
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

void SaveCase(const TrialCase& trial, const std::filesystem::path& file) {
  nlohmann::json hidden = nlohmann::json::array();
  for (const HiddenEffect& effect : trial.hidden)
    hidden.push_back({{"type", effect.type},
                      {"parameters", effect.parameters},
                      {"amplitude", effect.amplitude},
                      {"factor", effect.factor}});
  nlohmann::json forces = nlohmann::json::array();
  for (const Eigen::Vector3d& force : trial.hold_forces) forces.push_back(ToJson(force));
  const nlohmann::json all = {{"schema_version", 1},
                              {"name", trial.name},
                              {"group", trial.group},
                              {"seed", trial.seed},
                              {"recordings", trial.recordings},
                              {"is_scanned", trial.is_scanned},
                              {"nuisance", trial.nuisance},
                              {"hidden", hidden},
                              {"young_modulus", trial.young_modulus},
                              {"poisson_ratio", trial.poisson_ratio},
                              {"damping", trial.damping},
                              {"size", ToJson(trial.size)},
                              {"true_size", ToJson(trial.true_size)},
                              {"clamp_error", trial.clamp_error},
                              {"hold_forces", forces},
                              {"noise", trial.noise},
                              {"noise_correlation_time", trial.noise_correlation_time}};
  WriteFileAtomically(file, all.dump(2) + "\n");
}

TrialCase LoadCase(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw InputError(file.string() + ": cannot be opened");
  try {
    const auto json = nlohmann::json::parse(stream);
    TrialCase trial;
    trial.name = json.at("name");
    trial.group = json.at("group");
    trial.seed = json.at("seed");
    trial.recordings = json.at("recordings");
    trial.is_scanned = json.value("is_scanned", false);
    trial.nuisance = json.at("nuisance");
    for (const auto& effect : json.at("hidden"))
      trial.hidden.push_back({effect.at("type"), effect.at("parameters"), effect.at("amplitude"),
                              effect.at("factor")});
    trial.young_modulus = json.at("young_modulus");
    trial.poisson_ratio = json.at("poisson_ratio");
    trial.damping = json.at("damping");
    trial.size = VectorOf(json.at("size"));
    trial.true_size = VectorOf(json.at("true_size"));
    trial.clamp_error = json.at("clamp_error");
    for (const auto& force : json.at("hold_forces")) trial.hold_forces.push_back(VectorOf(force));
    trial.noise = json.at("noise");
    trial.noise_correlation_time = json.at("noise_correlation_time");
    return trial;
  } catch (const nlohmann::json::exception& problem) {
    throw InputError(fmt::format("{}: {}", file.string(), problem.what()));
  }
}

std::vector<std::filesystem::path> CasesIn(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder))
    throw InputError(folder.string() + ": there is no such folder");
  std::vector<std::filesystem::path> cases;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (std::filesystem::exists(entry.path() / "truth.json")) cases.push_back(entry.path());
  std::sort(cases.begin(), cases.end());
  return cases;
}

}  // namespace lacuna
