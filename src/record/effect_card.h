// The card of a physical effect: everything that the rest of the program must know of the effect
// besides its equations of motion.
//
// The card is defined next to the effect's code (src/effects/NAME.cc) and is the only place for
// these facts. The YAML check reads the parameters; `lacuna effects` and `lacuna explain` print the
// card; the diagnosis reads `tried_at` to enumerate the variants that it tries, and the experiment
// that it recommends; the sealed trials read `trial` to hide the effect in a synthetic recording.
// Values are in SI units. Cards are constant after their construction, so that any thread may read
// them.
#ifndef LACUNA_RECORD_EFFECT_CARD_H_
#define LACUNA_RECORD_EFFECT_CARD_H_

#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "core/config.h"
#include "core/quantity.h"

namespace lacuna {

// How the sealed trials (trials/trial_case.h) choose a parameter that is not the size of the
// effect. With neither a share nor a range the parameter keeps its default value.
struct TrialSetting {
  double share_of_length = 0;  // > 0: this share of the length of the bar
  // min < max: drawn between these values (SI), uniformly in the logarithm if the parameter has
  // `log_scale`. `draw` numbers the random draw of the case that gives the value; parameters of one
  // effect need different numbers. Numbers 0 and 6 to 8 are used for the place and the axis.
  // The numbers must not change, because the cases of a seed depend on them.
  double min = 0, max = 0;
  int draw = 0;

  bool IsDrawn() const { return min < max; }
};

// A parameter that has no value at which the effect vanishes.
inline constexpr double kNoNullValue = std::numeric_limits<double>::quiet_NaN();
// A parameter whose value the user must give, because there is no sensible default.
inline constexpr double kMustBeGiven = std::numeric_limits<double>::quiet_NaN();

// What makes some sizes of an effect plausible in a body and others not.
struct BodyScale {
  double young_modulus = 1e5;  // Pa
  double density = 1000;       // kg/m³
  double length = 0.1;         // m, the diagonal of the bounding box
};
// The body for which cards state plausible ranges.
inline constexpr BodyScale kReferenceBody;

struct ParameterCard {
  std::string name;           // the YAML key
  std::string meaning;        // one phrase
  Dimension dimension;        // dimension of the value, which is stored in SI units
  Bounds bounds = kAnyValue;  // the YAML check refuses values outside of these
  double null_value = 0;      // the value at which the effect vanishes, or kNoNullValue
  double plausible_min = 0;   // range of plausible values for soft objects, SI; its end that is
  double plausible_max = 0;   // farther from the null value (or 0) is the scale of the prior
  // The range is the one in kReferenceBody. In another body it is multiplied by the ratio of the
  // units of the parameter's dimension that consist of the body's Young's modulus E, density ρ and
  // length L: a stress by that of E, a force by that of E L² and a mass by that of ρ L³.
  bool of_body = false;
  double default_value = 0;  // SI, or kMustBeGiven
  bool log_scale = false;    // the fit and the trials use the logarithm of the value
  bool setting = false;      // describes where or how the effect acts; never fitted
  TrialSetting trial = {};
};

// The parameter with the range that is plausible in this body.
ParameterCard PlausibleIn(const BodyScale& body, ParameterCard parameter);

// The unit of a dimension of length, mass and time that consists of E, ρ and L: "E L^2" of a force.
std::string BodyUnitText(const Dimension& dimension);

// The variants with which the diagnosis tries an effect that the model lacks. A derivative at the
// null value determines the size of an effect, but not its place, direction or time scale, which
// are enumerated. The number of variants trades the time of the first-order ranking against the
// distance between an unknown place, direction or time and the nearest variant.
//
// The variants fill the parameters of the card by name: `centre` and `point` get a place, `axis`
// (or `azimuth` and `inclination`) a direction, `radius` the width of a place, `origin` and
// `length` the extent of a gradient. All other parameters take the model's value (those of the
// material, and gravity) or the default of the card.

// Tried as one variant, without enumeration.
struct TriedOnce {};

// Tried at places of the body: along the length of a bar, or spread over the volume of any other
// body.
struct TriedAtPlaces {
  std::vector<double> length_shares;  // for a bar: distance from one end over its length
  double radius_share = 0;            // width of each place over the length of the body
};

// Tried along the principal axes of the body and the diagonals between them (13 directions).
struct TriedAlongDirections {};

// Tried as a gradient along the length of a bar, or along the two longest axes of any other body.
struct TriedAsGradients {};

// Tried at values of one parameter.
struct TriedAtValues {
  std::string parameter;       // its name on the card
  std::string label;           // names the variant: "κ₀" gives "κ₀ = 0.1"
  std::vector<double> values;  // SI, in ascending order
};

// Tried at values of a relaxation time, by a factor of four from the time step of the simulation to
// the duration of the recordings.
struct TriedAtRelaxationTimes {
  std::string parameter;  // its name on the card
  std::string label;      // names the variant: "τ" gives "τ = 0.3 s"
};

// Tried on the whole surface, and around the girth near both ends and at the middle of the length;
// on each side of the body that is not gripped, the whole of it and places along the long sides. A
// support that slips is tried on the whole surface, around the girth and on each whole side, each
// of these at several slip distances.
struct TriedAsSupports {
  std::vector<double> slip_shares;  // values of `slip_distance` over the length of the body
};

// Tried at planes that the predicted body crosses and the measured one does not. Such a contact has
// no derivative at its null value, so it is tried by a simulation of its own.
struct TriedAtContactPlanes {};

using TriedAt =
    std::variant<TriedOnce, TriedAtPlaces, TriedAlongDirections, TriedAsGradients, TriedAtValues,
                 TriedAtRelaxationTimes, TriedAsSupports, TriedAtContactPlanes>;

// How the sealed trials hide the effect in a synthetic recording of a soft bar along x.
struct TrialDesign {
  // The model of every case has the effect, so that a case hides it by leaving it out of the model.
  bool is_in_every_model = false;
  bool axis_along_bar = false;  // the parameter `axis` is x, otherwise random
};

// What kind of physics an effect is. Effects of one family change a motion alike, so that a
// recording which cannot tell them apart may still show that one of the family is missing.
enum class EffectFamily {
  kOther,                  // no family: laws of the user
  kSteadyForce,            // loads that do not depend on the velocity
  kLossOutside,            // dissipation by the surroundings
  kLossInside,             // dissipation in the material
  kVolumeStress,           // stresses without an external load
  kStiffnessDistribution,  // stiffness that depends on place or direction
  kMassDistribution,       // density that depends on the place
  kElasticity,             // how the stress depends on large strains
  kContact,                // other bodies
};
// A phrase, e.g. "loss outside the body".
std::string FamilyTitle(EffectFamily family);
// The name in files, e.g. "loss_outside", and the reverse, which throws InputError.
std::string FamilyName(EffectFamily family);
EffectFamily FamilyFromName(const std::string& name);

struct EffectCard {
  std::string type;  // the YAML name, e.g. "viscous_damping"
  EffectFamily family = EffectFamily::kOther;
  std::string title;     // e.g. "Mass-proportional damping"
  std::string equation;  // in plain Unicode
  std::string citation;
  std::vector<ParameterCard> parameters;  // the size of the effect first
  std::string residual_when_missing;      // what the residual of a model without it looks like
  // An experiment that distinguishes the effect from its look-alikes; without a final full stop, so
  // that the diagnosis can append alternatives.
  std::string separating_experiment;
  // Types of effects that are easily confused with this one. The relation is symmetric and need be
  // stated on one of the two cards only (LookAlikesOf in effects/catalogue.h).
  std::vector<std::string> look_alikes;
  // Types of effects that a model must not contain beside this one. It need be stated on one of the
  // two cards only (MayStandBeside in effects/catalogue.h).
  std::vector<std::string> excludes = {};
  TriedAt tried_at = TriedOnce{};
  TrialDesign trial = {};
  // The length of the vector that makes the size, where nature fixes it (SI); 0: it does not.
  double natural_magnitude = 0;
  bool repeatable = false;  // a model may contain several, e.g. several walls
  // Invariances, which the test suite checks.
  bool conserves_momentum = false;          // the forces sum to zero
  bool conserves_angular_momentum = false;  // the torques sum to zero
};

// Index of the parameter of this name; −1 if the card has none.
inline int ParameterIndex(const EffectCard& card, const std::string& name) {
  for (size_t k = 0; k < card.parameters.size(); ++k)
    if (card.parameters[k].name == name) return static_cast<int>(k);
  return -1;
}

// Indices of the parameters that define the size of the effect: the first one, or the first three
// where these are the components of a vector. The card must have parameters.
inline std::vector<int> SizeParameters(const EffectCard& card) {
  if (card.parameters.front().name.ends_with("_x")) return {0, 1, 2};
  return {0};
}

// Whether the effect may hold an object without grips in place: supports, contacts, and laws of the
// user, of which it is not known.
inline bool MayHold(const EffectCard& card) {
  return std::holds_alternative<TriedAsSupports>(card.tried_at) ||
         card.family == EffectFamily::kContact || card.family == EffectFamily::kOther;
}

// Whether the diagnosis tries the effect by a simulation of its own (pilot) and not by a
// derivative.
inline bool IsContact(const EffectCard& card) {
  return std::holds_alternative<TriedAtContactPlanes>(card.tried_at);
}

}  // namespace lacuna

#endif  // LACUNA_RECORD_EFFECT_CARD_H_
