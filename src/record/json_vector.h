// Vectors of numbers as JSON arrays, in which null stands for NaN (core/json_number.h).
#ifndef LACUNA_RECORD_JSON_VECTOR_H_
#define LACUNA_RECORD_JSON_VECTOR_H_

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "core/json_number.h"

namespace lacuna {

inline nlohmann::json VectorToJson(const Eigen::Ref<const Eigen::VectorXd>& values) {
  nlohmann::json list = nlohmann::json::array();
  for (const double value : values) list.push_back(NumberOrNull(value));
  return list;
}

// Throws nlohmann::json::exception when `list` is not an array of numbers and nulls.
inline Eigen::VectorXd VectorFromJson(const nlohmann::json& list) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(list.size()));
  for (Eigen::Index k = 0; k < values.size(); ++k)
    values[k] = NumberOr(list.at(static_cast<size_t>(k)));
  return values;
}

}  // namespace lacuna

#endif  // LACUNA_RECORD_JSON_VECTOR_H_
