// Numbers in JSON, which has neither NaN nor infinity: both are written as null.
#ifndef LACUNA_RECORD_JSON_NUMBER_H_
#define LACUNA_RECORD_JSON_NUMBER_H_

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace lacuna {

inline nlohmann::json NumberToJson(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

// `absent` stands for null. Throws nlohmann::json::exception when the value is no number.
inline double NumberFromJson(const nlohmann::json& value,
                             double absent = std::numeric_limits<double>::quiet_NaN()) {
  return value.is_null() ? absent : value.get<double>();
}

// An array of numbers.
inline nlohmann::json NumbersToJson(const Eigen::Ref<const Eigen::VectorXd>& values) {
  nlohmann::json list = nlohmann::json::array();
  for (const double value : values) list.push_back(NumberToJson(value));
  return list;
}

// Throws nlohmann::json::exception when the value is no array of numbers.
inline Eigen::VectorXd NumbersFromJson(const nlohmann::json& list) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(list.size()));
  for (Eigen::Index k = 0; k < values.size(); ++k)
    values[k] = NumberFromJson(list.at(static_cast<size_t>(k)));
  return values;
}

}  // namespace lacuna

#endif  // LACUNA_RECORD_JSON_NUMBER_H_
