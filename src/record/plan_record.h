// Which next recording would decide between the effects that a diagnosis has left: plan/plan.json
// in the run's folder.
//
// λ is the squared distance of the predictions of two effects in units of the noise, after
// everything that is fitted has been projected out (RecordedSeparation). "Now" is with the
// recordings of the run alone, "then" with the planned one joined to them.
#ifndef LACUNA_RECORD_PLAN_RECORD_H_
#define LACUNA_RECORD_PLAN_RECORD_H_

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "record/model_errors.h"
#include "record/record_version.h"

namespace lacuna {

// With this λ two effects are told apart in about four recordings of five.
inline constexpr double kSeparableLambda = 12;

// An effect, or a pair of effects at once, that the diagnosis could not rule out.
struct PlannedRival {
  std::string effect, title;  // "mass_damping", "drag with gravity"; within a sentence
  double probability = 0;     // of the diagnosis, among the rivals; they sum to 1
  // How often recordings like those of the run lead to its name alone; 0 for a pair, which that
  // simulation does not weigh.
  double named_now = 0;
  std::vector<std::string> effects;  // the effect, or the two of a pair in alphabetical order
  double of_diagnosis = 0;           // its probability among all hypotheses of the diagnosis

  bool IsPair() const { return effects.size() == 2; }
};

// An error of the measurement or of the computation that the diagnosis could not rule out, and that
// a plan does not weigh.
struct LeftNuisance {
  std::string name, title;  // "grip_compliance"; within a sentence
  double probability = 0;   // that it alone is the cause, among all hypotheses of the diagnosis
};

struct PlannedPair {
  std::string first, second;
  double lambda_now = 0, lambda_then = 0;
};

// One of the parameters that define the size of a rival, SI, with the half-width of its 95 %
// interval, which its prior limits where the recordings do not determine it.
struct PlannedSize {
  std::string effect;     // PlannedRival::effect
  std::string parameter;  // "coefficient"; of a pair with its effect: "drag.coefficient"
  std::string unit;
  double value = 0, half_width_now = 0, half_width_then = 0;
};

// What is done to the object over time.
struct ProtocolCurve {
  std::string what;       // "path of the clamp", "force of the hand"
  std::string component;  // "x"; empty for a scalar
  std::string unit;       // SI
  std::vector<double> values;
};
struct ProtocolPicture {
  std::vector<double> times;      // s; empty: nothing is known to change
  std::optional<double> release;  // s
  std::vector<ProtocolCurve> curves;
};

// What a planned recording would tell.
struct PlannedOutcome {
  std::string name;                // of the protocol
  std::string what;                // what is done, in words
  double seconds = 0;              // of recording
  std::string message;             // why the model cannot play it; empty: it can
  std::vector<double> named;       // for each rival: the probability of its name, if it is missing
  double probability = 0;          // of the right name, rivals weighted by their probability
  std::vector<PlannedPair> pairs;  // of rivals
  std::vector<PlannedSize> sizes;
  ProtocolPicture picture = {};
  std::string experiment;  // the YAML file that was written, relative to plan.json
  // Nuisances that could not be tried with this recording: `named`, `pairs` and `sizes` do not
  // count them, and promise too much where they matter.
  std::vector<UntriedEffect> untried = {};

  bool IsPlayable() const { return message.empty(); }
  // The smallest λ of a pair with the recording; infinite where there is no pair.
  double LeastLambda() const;
};

struct PlanRecord {
  std::string diagnosis;                // hash of the diagnosis.json that the plan starts from
  std::string run;                      // the name of the experiment
  std::string verdict;                  // of the diagnosis, with its names
  std::vector<PlannedRival> rivals;     // the most probable one first
  double no_effect = 0;                 // probability of the diagnosis that no effect is missing
  std::vector<LeftNuisance> also_left;  // in the order of the diagnosis
  // Rivals that are not weighed: beyond kMostPlannedRivals, or with an unknown influence on a
  // planned recording.
  std::vector<std::string> not_predicted;
  std::vector<PlannedOutcome> outcomes;  // the best first; those that cannot be played last
};

// Sorts by the probability of the right name, rounded to 5 % because a simulation does not know it
// better; where that is the same, by the shorter recording, then by the larger least λ, then by the
// order given. What cannot be played comes last.
void SortOutcomes(std::vector<PlannedOutcome>* outcomes);

// Whether a plan was made from the diagnosis whose diagnosis.json has this hash. False for a file
// that is no plan. Throws InputError when it cannot be read or is not JSON.
bool IsPlanOf(const std::string& diagnosis, const std::filesystem::path& file);

// The version of Lacuna whose format a plan has. Throws InputError when the file cannot be read or
// is not JSON.
RecordVersion VersionOfPlan(const std::filesystem::path& file);

// Throws InputError when the file cannot be written.
void WritePlanFile(const PlanRecord& record, const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_RECORD_PLAN_RECORD_H_
