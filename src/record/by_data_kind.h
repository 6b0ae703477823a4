// One number for each kind of data that a model is fitted to.
#ifndef LACUNA_RECORD_BY_DATA_KIND_H_
#define LACUNA_RECORD_BY_DATA_KIND_H_

#include <nlohmann/json_fwd.hpp>
#include <utility>

namespace lacuna {

struct ByDataKind {
  double markers = 0;  // tracked points included
  double scans = 0;    // point clouds, depth images, meshes
  double forces = 0;   // torques included
};

// The number of one kind.
using DataKind = double ByDataKind::*;

// The kinds, with the names that they have in reports and in JSON.
inline constexpr std::pair<const char*, DataKind> kDataKinds[] = {{"markers", &ByDataKind::markers},
                                                                  {"scans", &ByDataKind::scans},
                                                                  {"forces", &ByDataKind::forces}};

nlohmann::json ByDataKindToJson(const ByDataKind& numbers);
// Throws nlohmann::json::exception.
ByDataKind ByDataKindFromJson(const nlohmann::json& value);

}  // namespace lacuna

#endif  // LACUNA_RECORD_BY_DATA_KIND_H_
