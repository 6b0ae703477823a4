// Numbers in JSON, which has neither NaN nor infinity: null stands for a number that is not finite.
#ifndef LACUNA_CORE_JSON_NUMBER_H_
#define LACUNA_CORE_JSON_NUMBER_H_

#include <cmath>
#include <limits>
#include <nlohmann/json_fwd.hpp>

namespace lacuna {

// The JSON number, or null if `value` is NaN or infinite. `Json` is nlohmann::json or ordered_json;
// the calling file includes <nlohmann/json.hpp>.
template <typename Json = nlohmann::json>
Json NumberOrNull(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

// The reverse: the number in `value`, or `if_null` where it is null. Throws nlohmann's type_error
// for anything other than a number or null.
template <typename Json>
double NumberOr(const Json& value, double if_null = std::numeric_limits<double>::quiet_NaN()) {
  return value.is_null() ? if_null : value.template get<double>();
}

}  // namespace lacuna

#endif  // LACUNA_CORE_JSON_NUMBER_H_
