// A model as JSON, beside its mesh: every value in SI units and with all digits.
#ifndef LACUNA_EXCHANGE_MODEL_JSON_H_
#define LACUNA_EXCHANGE_MODEL_JSON_H_

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "exchange/counterpart.h"

namespace lacuna {

// Every part of the model is exact.
Counterparts JsonCounterparts(const PortableModel& model);

// `mesh_file` is the name of the file of the mesh. Nodes are numbered from 0; vectors are lists of
// three numbers, and a motion or force is a list of them for each of `times`. An effect with
// expressions has the key "yaml", its mapping in an experiment.
nlohmann::ordered_json ModelJson(const PortableModel& model, const std::string& mesh_file);

}  // namespace lacuna

#endif  // LACUNA_EXCHANGE_MODEL_JSON_H_
