#include "record/agreement_record.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/json_number.h"

namespace lacuna {

using nlohmann::json;

const ParameterOfRecordings* AgreementRecord::MostDifferent() const {
  const auto least =
      std::min_element(parameters.begin(), parameters.end(),
                       [](const auto& a, const auto& b) { return a.p_value < b.p_value; });
  return least == parameters.end() ? nullptr : &*least;
}

json AgreementToJson(const AgreementRecord& agreement) {
  json parameters = json::array();
  for (const ParameterOfRecordings& parameter : agreement.parameters) {
    json values = json::array(), deviations = json::array();
    for (const double value : parameter.values) values.push_back(NumberOrNull(value));
    for (const double deviation : parameter.deviations)
      deviations.push_back(NumberOrNull(deviation));
    parameters.push_back({{"name", parameter.name},
                          {"unit", parameter.unit},
                          {"values", values},
                          {"deviations", deviations},
                          {"p_value", parameter.p_value},
                          {"odd_recording", parameter.odd_recording}});
  }
  return {{"recordings", agreement.recordings},
          {"parameters", parameters},
          {"chi_square", agreement.chi_square},
          {"degrees_of_freedom", agreement.degrees_of_freedom},
          {"p_value", agreement.p_value}};
}

AgreementRecord AgreementFromJson(const json& value) {
  AgreementRecord agreement;
  agreement.recordings = value.at("recordings").get<std::vector<std::string>>();
  for (const json& entry : value.at("parameters")) {
    ParameterOfRecordings& parameter = agreement.parameters.emplace_back();
    parameter.name = entry.at("name");
    parameter.unit = entry.at("unit");
    for (const json& number : entry.at("values"))
      parameter.values.push_back(NumberOr(number, std::numeric_limits<double>::quiet_NaN()));
    for (const json& number : entry.at("deviations"))
      parameter.deviations.push_back(NumberOr(number, std::numeric_limits<double>::infinity()));
    parameter.p_value = entry.at("p_value");
    parameter.odd_recording = entry.at("odd_recording");
  }
  agreement.chi_square = value.at("chi_square");
  agreement.degrees_of_freedom = value.at("degrees_of_freedom");
  agreement.p_value = value.at("p_value");
  return agreement;
}

}  // namespace lacuna
