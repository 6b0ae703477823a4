// The catalogue of all physical effects that Lacuna knows, by their YAML names.
//
// A new effect needs its own .cc file with its card, one line in catalogue.cc (with the declaration
// of its entry above it), a test and a file in configs/effects. The list is written by hand because
// the linker drops self-registration from a static library. The catalogue is constant and may be
// read by any thread. Parameter values are in SI units, in the order of the effect's card.
#ifndef LACUNA_EFFECTS_CATALOGUE_H_
#define LACUNA_EFFECTS_CATALOGUE_H_

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/config.h"
#include "fem/effect.h"

namespace lacuna {

struct CatalogueEntry {
  enum class Kind {
    kMaterial,  // an elasticity law of the body: `material: {law: …}`
    kEffect,    // any other effect: `effects: [{type: …}]`
  };
  const EffectCard* card = nullptr;
  Kind kind = Kind::kEffect;

  // An effect that its parameter values describe in full has the next two functions. An effect that
  // has more than these, such as an expression, and therefore a card of its own of the same type as
  // `card`, has the two after them. The others are null: `make != nullptr` tells which it is.
  //
  // Makes the effect from its parameter values.
  std::shared_ptr<const Effect> (*make)(const Eigen::VectorXd& parameters) = nullptr;
  // Reads the parameter values of a YAML mapping. A parameter that the mapping omits may be taken
  // from `material`, the elasticity law of the body, which may be null, or from `gravity`, that of
  // the model in m/s² (nothing: the model has none).
  Eigen::VectorXd (*read)(const EffectCard& card, const Config& config, const Effect* material,
                          const std::optional<Eigen::Vector3d>& gravity) = nullptr;
  // Makes the effect from the YAML mapping that describes it, and writes that mapping.
  std::shared_ptr<const Effect> (*make_from_yaml)(const Config& config) = nullptr;
  std::string (*format)(const Effect& effect) = nullptr;

  // Whether the effect is a law that the user writes: a diagnosis tries those that an experiment
  // lists as candidates, each under its own name.
  bool is_own_law = false;
};

// Every entry; the elasticity laws come first.
const std::vector<CatalogueEntry>& Catalogue();

// The entry of this type, or null.
const CatalogueEntry* FindEntry(const std::string& type);

// The types of the effects that are easily confused with this one: those on its own card in their
// order, then those whose cards name this effect. A new effect thus names its look-alikes on its
// own card alone.
std::vector<std::string> LookAlikesOf(const EffectCard& card);

// Whether a model may contain effects of both cards: neither of them excludes the other, and two
// effects have the same type only if it is repeatable.
bool MayStandBeside(const EffectCard& one, const EffectCard& other);

// The effect that `{type: mass_damping, alpha: 0.5 1/s}` describes, for a model with this material
// and gravity (`read` above). Throws InputError at the key when the type is unknown or a parameter
// is missing, has the wrong unit, is out of bounds or contradicts the model.
std::shared_ptr<const Effect> MakeEffect(
    const Config& config, const Effect* material = nullptr,
    const std::optional<Eigen::Vector3d>& gravity = std::nullopt);

// The elasticity law that `{law: neo_hookean, young_modulus: 0.1 MPa, poisson_ratio: 0.3}`
// describes. Throws InputError as MakeEffect does.
std::shared_ptr<const Effect> MakeMaterial(const Config& config);

// An effect from parameter values by name, SI. An omitted parameter takes the default value of the
// card. The caller must know the catalogue (CHECK): a type or a parameter that does not exist, a
// parameter without a value, and an effect that only YAML can describe are programming errors.
std::shared_ptr<const Effect> MakeEffect(const std::string& type,
                                         const std::map<std::string, double>& parameters);

// The usual `make`, for a class whose constructor takes the parameter values.
template <typename Type>
std::shared_ptr<const Effect> MakeAs(const Eigen::VectorXd& parameters) {
  return std::make_shared<Type>(parameters);
}

// The usual `read`. Each parameter of the card has a key of its own name; three parameters n_x, n_y
// and n_z form one vector, `n: [0, 0, 1]`. A dimensionless vector is a direction: its length may be
// anything but 0. An omitted parameter takes the default value of the card; without a default, the
// value of the material's parameter of the same name. Throws InputError if there is neither. The
// setting `gravity` (free_fall.h) in a model with gravity is that of the model, also if it is
// omitted, or 0; another value is refused.
Eigen::VectorXd ReadParameters(const EffectCard& card, const Config& config, const Effect* material,
                               const std::optional<Eigen::Vector3d>& gravity);

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_CATALOGUE_H_
