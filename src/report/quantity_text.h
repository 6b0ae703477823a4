// Text of quantities, directions, probabilities and enumerations in sentences.
#ifndef LACUNA_REPORT_QUANTITY_TEXT_H_
#define LACUNA_REPORT_QUANTITY_TEXT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

namespace lacuna {

// A length in m, as "0.870 mm", with two significant digits below 0.1 mm; NaN is "an unknown
// length".
std::string Millimetres(double length);

// "p = 0.03", or "p ≤ 0.001".
std::string ProbabilityText(double p_value);

// A probability from 0 to 1 as "78 %", "< 1 %" or "> 99 %".
std::string PercentText(double probability);

// "a", "a and b", "a, b and c"; empty for no phrases.
std::string EnumerationText(const std::vector<std::string>& phrases);

// "12 Pa"; the text alone without a unit.
std::string WithUnit(const std::string& text, const std::string& unit);

// The axis nearest to a direction, as "+x". If the angle between them exceeds 30 degrees, the
// second axis too: "−z and +x", the larger component first.
std::string DirectionText(const Eigen::Vector3d& vector);

}  // namespace lacuna

#endif  // LACUNA_REPORT_QUANTITY_TEXT_H_
