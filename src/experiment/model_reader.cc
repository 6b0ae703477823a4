#include "experiment/model_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/expression.h"
#include "effects/catalogue.h"
#include "effects/gravity.h"

namespace lacuna {

MeshSettings ReadMeshSettings(const Config& config) {
  MeshSettings settings;
  settings.tets.radius_edge_ratio =
      config.Number("radius_edge_ratio", {1, 100, true, false}, settings.tets.radius_edge_ratio);
  settings.tets.max_volume = config.Quantity("max_volume", kVolume, kPositive);
  // Left out where it is not given, so that results kept under the hash of older files stay valid.
  if (config.Has("min_dihedral_angle"))
    settings.tets.min_dihedral_angle =
        config.Quantity("min_dihedral_angle", kAngle, {0, 1.2, false, false});
  settings.tets.preserve_surface = config.Flag("preserve_surface", settings.tets.preserve_surface);
  settings.order = config.Integer("order", 1, 2, 1);
  return settings;
}

namespace {

bool Contain(const EffectList& effects, const std::string& type) {
  return std::any_of(effects.begin(), effects.end(),
                     [&](const auto& effect) { return effect->Card().type == type; });
}

// Refuses `item`, an effect with this card, if one of `others` excludes it.
void RequireNotExcluded(const Config& item, const EffectCard& card, const EffectList& others) {
  for (const auto& other : others) {
    const EffectCard& beside = other->Card();
    if (beside.type == card.type || MayStandBeside(beside, card)) continue;
    item.Fail("type", fmt::format("{0} cannot be combined with {1}; `lacuna explain {0}` and "
                                  "`lacuna explain {1}` describe them",
                                  card.type, beside.type));
  }
}

}  // namespace

EffectList ReadEffects(const Config& config) {
  EffectList effects = {MakeMaterial(config.Child("material"))};
  const EffectList listed = ReadEffectsBeside(effects, config);
  effects.insert(effects.end(), listed.begin(), listed.end());
  return effects;
}

EffectList ReadEffectsBeside(const EffectList& others, const Config& config) {
  EffectList effects;
  const std::optional<Eigen::Vector3d> gravity = ReadModelGravity(config, others);
  for (const Config& item : config.Items("effects")) {
    const auto effect = MakeEffect(item, others.front().get(), gravity);
    const EffectCard& card = effect->Card();
    if (!card.repeatable && Contain(effects, card.type))
      item.Fail("type", fmt::format("{} is listed twice", card.type));
    if (!card.repeatable && Contain(others, card.type))
      item.Fail("type",
                fmt::format("{0} is already listed among the effects of the experiment, which "
                            "act in every recording, and a model can have it only once; if {0} "
                            "differs between the recordings, list it in each of them instead",
                            card.type));
    RequireNotExcluded(item, card, others);
    RequireNotExcluded(item, card, effects);
    effects.push_back(effect);
  }
  return effects;
}

std::optional<Eigen::Vector3d> ReadModelGravity(const Config& config, const EffectList& others) {
  for (const Config& item : config.Items("effects")) {
    if (!item.Has("type") || item.Text("type") != GravityCard().type) continue;
    const Eigen::Vector3d gravity = MakeEffect(item)->Parameters();
    for (const auto& other : others) {
      const std::optional<Eigen::Vector3d> own = GravitySettingOf(*other);
      if (own && !own->isZero(0) && !IsSameGravity(*own, gravity))
        item.Fail("type", fmt::format("differs from the {} of {} among the experiment's effects; "
                                      "list both there, or both here",
                                      kGravitySetting, other->Card().type));
    }
    return gravity;
  }
  return GravityOf(others);
}

std::vector<OwnLaw> ReadCandidates(const Config& config, const Effect* material) {
  std::vector<OwnLaw> laws;
  for (const Config& item : config.Items("candidates")) {
    const std::string type = item.Text("type");
    if (const CatalogueEntry* entry = FindEntry(type); entry != nullptr && !entry->is_own_law)
      item.Fail("type", fmt::format("{}; candidates are user-defined laws of type expression",
                                    entry->make != nullptr
                                        ? fmt::format("a diagnosis tries {} anyway", type)
                                        : fmt::format("a diagnosis cannot try {}", type)));
    const OwnLaw law{item.Text("name", ""), MakeEffect(item, material)};
    if (!Expression::IsName(law.name))
      item.Fail("name", "must consist of letters, digits and underscores");
    if (FindEntry(law.name) != nullptr)
      item.Fail("name", "is the name of an effect of the catalogue");
    for (const OwnLaw& other : laws)
      if (other.name == law.name) item.Fail("name", "is the name of another candidate");
    laws.push_back(law);
  }
  return laws;
}

std::vector<std::string> ImplausibleParameters(const EffectList& effects, const BodyScale& body) {
  constexpr double kFar = 10;  // factor beyond the limits of the plausible range
  std::vector<std::string> warnings;
  for (const auto& effect : effects) {
    const EffectCard& card = effect->Card();
    const Eigen::VectorXd values = effect->Parameters();
    for (size_t k = 0; k < card.parameters.size(); ++k) {
      const ParameterCard parameter = PlausibleIn(body, card.parameters[k]);
      const double value = values[static_cast<Eigen::Index>(k)];
      const bool too_small =
          parameter.log_scale && value > 0 && value < parameter.plausible_min / kFar;
      const bool too_large = std::abs(value) > kFar * std::max(std::abs(parameter.plausible_min),
                                                               std::abs(parameter.plausible_max));
      if (!too_small && !too_large) continue;
      warnings.push_back(fmt::format("{}.{} is {:g} {}; {:g} to {:g} is usual for soft objects",
                                     card.type, parameter.name, value, parameter.dimension.unit,
                                     parameter.plausible_min, parameter.plausible_max));
    }
  }
  return warnings;
}

std::string AuxeticWarning(const EffectList& effects) {
  for (const auto& effect : effects) {
    const EffectCard& card = effect->Card();
    for (size_t k = 0; k < card.parameters.size(); ++k) {
      const double value = effect->Parameters()[static_cast<Eigen::Index>(k)];
      if (card.parameters[k].name != "poisson_ratio" || !(value < 0)) continue;
      return fmt::format(
          "{}.poisson_ratio is {:g}: an auxetic material, which becomes wider when it is "
          "stretched; was this meant?",
          card.type, value);
    }
  }
  return "";
}

std::string GravityWarning(const RecordedObject& object, const EffectList& effects) {
  if (!object.gravity || object.gravity->isZero(0) || GravityOf(effects)) return "";
  return "the object was recorded under gravity, but the model has none; this is valid only if the "
         "reference shape was measured under the same gravity";
}

TimeScheme ReadTimeScheme(const Config& config, const std::string& default_name) {
  return config.Choice<TimeScheme>("scheme",
                                   {{"quasi_static", TimeScheme::kQuasiStatic},
                                    {"implicit_euler", TimeScheme::kImplicitEuler},
                                    {"bdf2", TimeScheme::kBdf2},
                                    {"two_step", TimeScheme::kTwoStep}},
                                   default_name);
}

double Profile::At(double time) const {
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  if (after == times.begin()) return values.front();
  if (after == times.end()) return values.back();
  const size_t i = static_cast<size_t>(after - times.begin());
  const double share = (time - times[i - 1]) / (times[i] - times[i - 1]);
  return values[i - 1] + share * (values[i] - values[i - 1]);
}

Profile ReadProfile(const Config& config) {
  const std::optional<Config> entry = config.OptionalChild("profile");
  if (!entry) return {{0.0}, {1.0}};
  Profile profile;
  profile.times = entry->Quantities("times", kTime, kAnyValue);
  profile.values = entry->Quantities("values", kDimensionless, kAnyValue);
  if (profile.times.empty()) entry->Fail("times", "expected a list of times, e.g. [0 s, 0.5 s]");
  if (profile.values.size() != profile.times.size()) {
    entry->Fail("values", "expected as many values as times");
  }
  for (size_t i = 1; i < profile.times.size(); ++i) {
    if (!(profile.times[i] > profile.times[i - 1]))
      entry->Fail("times", "expected ascending times");
  }
  return profile;
}

Eigen::VectorXi NodesIn(const Region& region, const TetMesh& mesh) {
  const std::vector<int> selected = SelectNodes(region, mesh);
  return Eigen::Map<const Eigen::VectorXi>(selected.data(),
                                           static_cast<Eigen::Index>(selected.size()));
}

}  // namespace lacuna
