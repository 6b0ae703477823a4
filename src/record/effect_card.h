// What the program knows of a physical effect in words and numbers, written once beside the
// effect's code and read by the YAML check, `lacuna effects`, `explain`, `diagnose` and the report.
#ifndef LACUNA_RECORD_EFFECT_CARD_H_
#define LACUNA_RECORD_EFFECT_CARD_H_

#include <string>
#include <vector>

#include "core/config.h"
#include "core/quantity.h"

namespace lacuna {

struct ParameterCard {
  std::string name;           // the YAML key
  std::string meaning;        // one phrase
  Dimension dimension;        // of the value; SI inside
  Bounds bounds = kAnyValue;  // values outside make no sense: the YAML check refuses them
  double null_value = 0;      // the value at which the effect vanishes (NaN where it has none)
  double plausible_min = 0;   // plausible range for soft objects, SI; also the scale of its prior
  double plausible_max = 0;
  double default_value = 0;  // SI; NaN: the user must give it
  bool log_scale = false;    // searched on a logarithmic scale
  bool setting = false;      // says where or how the effect acts: given, never fitted
};

struct EffectCard {
  std::string type;      // the YAML name, e.g. "viscous_damping"
  std::string title;     // e.g. "Mass-proportional damping"
  std::string equation;  // in plain Unicode
  std::string citation;
  std::vector<ParameterCard> parameters;
  std::string residual_when_missing;     // what a user sees when the model lacks it
  std::string separating_experiment;     // what tells it from its look-alikes
  std::vector<std::string> look_alikes;  // types of effects easily taken for it
  bool repeatable = false;               // a model may have several, e.g. walls
  // Invariances that the test suite then checks.
  bool conserves_momentum = false;          // forces sum to zero
  bool conserves_angular_momentum = false;  // torques sum to zero
};

}  // namespace lacuna

#endif  // LACUNA_RECORD_EFFECT_CARD_H_
