#include "study/physics.h"

#include <algorithm>
#include <cmath>

#include "effects/catalogue.h"

namespace lacuna {

MeshSettings ReadMeshSettings(const Config& config) {
  MeshSettings settings;
  settings.tets.radius_edge_ratio =
      config.Number("radius_edge_ratio", {1, 100, false, false}, settings.tets.radius_edge_ratio);
  settings.tets.max_volume = config.Quantity("max_volume", kVolume, kPositive);
  settings.order = config.Integer("order", 1, 2, 1);
  return settings;
}

std::vector<std::shared_ptr<Effect>> ReadEffects(const Config& config) {
  std::vector<std::shared_ptr<Effect>> effects;
  effects.push_back(MakeMaterial(config.Child("material")));
  for (const Config& item : config.Items("effects"))
    effects.push_back(MakeEffect(item, effects.front().get()));
  return effects;
}

TimeScheme ReadTimeScheme(const Config& config, const std::string& default_name) {
  return config.Choice<TimeScheme>("scheme",
                                   {{"quasi_static", TimeScheme::kQuasiStatic},
                                    {"implicit_euler", TimeScheme::kImplicitEuler},
                                    {"bdf2", TimeScheme::kBdf2}},
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

Eigen::VectorXi NodesIn(const Region& region, const Eigen::Matrix3Xd& nodes) {
  const std::vector<int> selected = SelectNodes(region, nodes);
  return Eigen::Map<const Eigen::VectorXi>(selected.data(),
                                           static_cast<Eigen::Index>(selected.size()));
}

}  // namespace lacuna
