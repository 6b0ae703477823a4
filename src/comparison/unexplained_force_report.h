// The unexplained force as a table, as JSON and in words.
#ifndef LACUNA_COMPARISON_UNEXPLAINED_FORCE_REPORT_H_
#define LACUNA_COMPARISON_UNEXPLAINED_FORCE_REPORT_H_

#include <nlohmann/json.hpp>
#include <string>

#include "comparison/unexplained_force.h"

namespace lacuna {

std::string ForceTableHeader();
// Lines of the table, `recording` in the first column.
std::string ForceTableRows(const UnexplainedForce& force, size_t recording);
nlohmann::json ToJson(const UnexplainedForce& force);
// A paragraph that begins with the recording's name.
std::string ForceInWords(const UnexplainedForce& force, const std::string& recording);

// "+x", or the two axes that make up a direction, the larger first: "−z and +x".
std::string DirectionInWords(const Eigen::Vector3d& vector);

}  // namespace lacuna

#endif  // LACUNA_COMPARISON_UNEXPLAINED_FORCE_REPORT_H_
