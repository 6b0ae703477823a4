#include "effects/vector_parameters.h"

#include <cmath>

namespace lacuna {
namespace {

constexpr double kStandardGravity = 9.80665;  // m/s²

// The name of the vector whose first component is parameter k; empty where there is none.
std::string VectorStartingAt(const EffectCard& card, size_t k) {
  if (k + 2 >= card.parameters.size()) return "";
  const std::string& name = card.parameters[k].name;
  if (!name.ends_with("_x")) return "";
  std::string stem = name.substr(0, name.size() - 2);
  const bool is_vector =
      card.parameters[k + 1].name == stem + "_y" && card.parameters[k + 2].name == stem + "_z";
  return is_vector ? stem : "";
}

}  // namespace

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

void AppendGravitySetting(EffectCard* card) {
  AppendVector({.name = "gravity",
                .meaning = "acceleration of free fall, which must be that of the model's gravity "
                           "(0, 0, 0 in a model without),",
                .dimension = kAcceleration,
                .bounds = kAnyValue,
                .null_value = 0,
                .plausible_min = -kStandardGravity,
                .plausible_max = kStandardGravity,
                .setting = true},
               {0, 0, -kStandardGravity}, card);
}

Eigen::VectorXd ReadParametersAndVectors(const EffectCard& card, const Config& config,
                                         const Effect* /*material*/) {
  Eigen::VectorXd values(card.parameters.size());
  for (size_t k = 0; k < card.parameters.size(); ++k) {
    const ParameterCard& parameter = card.parameters[k];
    const bool required = std::isnan(parameter.default_value);
    const std::string vector = VectorStartingAt(card, k);
    if (vector.empty()) {
      values[k] = required ? config.Quantity(parameter.name, parameter.dimension, parameter.bounds)
                           : config.Quantity(parameter.name, parameter.dimension, parameter.bounds,
                                             parameter.default_value);
      continue;
    }
    const Eigen::Vector3d default_value(parameter.default_value,
                                        card.parameters[k + 1].default_value,
                                        card.parameters[k + 2].default_value);
    const Eigen::Vector3d given = required
                                      ? config.Vector(vector, parameter.dimension)
                                      : config.Vector(vector, parameter.dimension, default_value);
    if (parameter.dimension.SameAs(kDimensionless) && config.Has(vector) && given.norm() == 0) {
      config.Fail(vector, "expected a direction other than 0");
    }
    values.segment<3>(static_cast<Eigen::Index>(k)) = given;
    k += 2;
  }
  return values;
}

}  // namespace lacuna
