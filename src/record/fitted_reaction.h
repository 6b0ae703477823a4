// The fit of a model to the measured reaction of one grip, as plain data.
//
// The reaction is the force that the grip exerts on the object, N, or a torque, N m, which has the
// latter unit wherever the former is mentioned. σ is the standard deviation of
// the noise of one reading of one component. The tare is the offset of a component that is the same
// at all times, predicted minus measured; the errors do not contain it.
#ifndef LACUNA_RECORD_FITTED_REACTION_H_
#define LACUNA_RECORD_FITTED_REACTION_H_

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace lacuna {

// The errors over some frames.
struct ReactionMeasure {
  int frames = 0;
  int values = 0;             // components that were read, summed over the frames
  double rms = 0;             // N, of a component
  double largest = 0;         // N
  double rms_over_sigma = 0;  // 1 is noise alone
};

// Errors of a measured force that exceed this share of its largest reading are more than those of
// the elements cause, so that mistakes in the reading are looked for. Smaller: coarse elements look
// like a mistake.
inline constexpr double kConsiderableReactionError = 0.03;

// Mistakes in a reading, each of which would explain nearly all of its misfit, up to a factor on
// the prediction where that stands for other moduli. A factor and an offset explain it together
// only.
struct ReadingMistakes {
  std::optional<double> factor;  // the reading is this multiple of the force; negative: the sign
  std::optional<double> offset;  // N, the largest of its components
  std::optional<double> delay;   // s, by which the reading comes late
};

struct FittedReaction {
  std::string name;  // of the grip
  bool is_torque = false;
  bool is_opposite = false;         // the reading was found to be that of the opposite force
  std::vector<std::string> labels;  // of the components: "x", "y", "z", or "along"
  double deviation = 0;             // N, σ
  bool deviation_is_estimated = false;
  double tare_deviation = 0;   // N, of the prior
  std::vector<double> tare;    // N, for each component
  double largest_reading = 0;  // N
  ReactionMeasure in_fit, held_out;
  ReadingMistakes likely_mistakes = {};  // looked for beyond kConsiderableReactionError only

  const char* Unit() const { return is_torque ? "N m" : "N"; }
  const char* Quantity() const { return is_torque ? "torque" : "force"; }
};

nlohmann::json ReactionToJson(const FittedReaction& reaction);
// Throws nlohmann::json::exception.
FittedReaction ReactionFromJson(const nlohmann::json& value);

}  // namespace lacuna

#endif  // LACUNA_RECORD_FITTED_REACTION_H_
