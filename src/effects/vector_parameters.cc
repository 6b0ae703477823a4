#include "effects/vector_parameters.h"

namespace lacuna {

void AppendVector(const ParameterCard& common, const Eigen::Vector3d& default_value,
                  EffectCard* card) {
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    ParameterCard component = common;
    component.name += std::string("_") + kAxes[k];
    component.meaning += std::string(" along ") + kAxes[k];
    component.default_value = default_value[k];
    card->parameters.push_back(component);
  }
}

void AppendDirectionSetting(const std::string& name, const std::string& meaning,
                            const Eigen::Vector3d& default_value, EffectCard* card) {
  AppendVector({.name = name,
                .meaning = meaning,
                .dimension = kDimensionless,
                .null_value = kNoNullValue,
                .plausible_min = -1,
                .plausible_max = 1,
                .setting = true},
               default_value, card);
}

void AppendPointSetting(const std::string& name, const std::string& meaning, EffectCard* card) {
  AppendVector({.name = name,
                .meaning = meaning,
                .dimension = kLength,
                .null_value = kNoNullValue,
                .plausible_min = -1,
                .plausible_max = 1,
                .setting = true},
               Eigen::Vector3d::Zero(), card);
}

std::string VectorNameAt(const EffectCard& card, size_t k) {
  const std::string& first = card.parameters[k].name;
  if (k + 2 >= card.parameters.size() || !first.ends_with("_x")) return "";
  const std::string name = first.substr(0, first.size() - 2);
  const bool complete =
      card.parameters[k + 1].name == name + "_y" && card.parameters[k + 2].name == name + "_z";
  return complete ? name : "";
}

void AppendPlace(const std::string& meaning, EffectCard* card) {
  AppendVector({.name = "centre",
                .meaning = meaning,
                .dimension = kLength,
                .null_value = kNoNullValue,
                .plausible_min = -0.2,
                .plausible_max = 0.2,
                .of_body = true},
               Eigen::Vector3d::Constant(kMustBeGiven), card);
  card->parameters.push_back({.name = "radius",
                              .meaning = "spread about that place (standard deviation), r",
                              .dimension = kLength,
                              .bounds = kPositive,
                              .null_value = kNoNullValue,
                              .plausible_min = 1e-3,
                              .plausible_max = 0.05,
                              .of_body = true,
                              .default_value = 0.005,
                              .log_scale = true,
                              .setting = true});
}

}  // namespace lacuna
