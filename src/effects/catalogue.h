// All physical effects that Lacuna knows, by their YAML names.
//
// A new effect: its .cc file, one line in catalogue.cc (with the declaration of its entry above), a
// test, a YAML entry.
#ifndef LACUNA_EFFECTS_CATALOGUE_H_
#define LACUNA_EFFECTS_CATALOGUE_H_

#include <Eigen/Core>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/config.h"
#include "fem/effect.h"

namespace lacuna {

struct CatalogueEntry {
  enum class Kind {
    kMaterial,  // the elasticity law of the body: `material: {law: …}`
    kEffect,    // anything that acts besides: `effects: [{type: …}]`
  };
  const EffectCard* card = nullptr;
  Kind kind = Kind::kEffect;
  // From parameter values in the order of the card, SI.
  std::shared_ptr<const Effect> (*make)(const Eigen::VectorXd& parameters) = nullptr;
  // The parameter values of a YAML mapping. `material`: the body's elasticity law, from which an
  // effect may take what its own mapping leaves out; may be null.
  Eigen::VectorXd (*read)(const EffectCard& card, const Config& config,
                          const Effect* material) = nullptr;
  // In place of `make` and `read`, which are then null: an effect that is more than its numbers and
  // whose card is its own, of the same type as `card`.
  std::shared_ptr<const Effect> (*make_from_yaml)(const Config& config) = nullptr;
  // The mapping that is read back to such an effect.
  std::string (*format)(const Effect& effect) = nullptr;
};

// Every entry, elasticity laws first.
const std::vector<CatalogueEntry>& Catalogue();

// The entry of this name, or null.
const CatalogueEntry* FindEntry(const std::string& type);

// Where the card's parameter of this name stands; −1: it has none.
int ParameterIndex(const EffectCard& card, const std::string& name);

// The effect that `{type: mass_damping, alpha: 0.5 1/s}` describes. Throws InputError at the key
// when the type is unknown or a parameter is missing, has the wrong unit or is out of bounds.
std::shared_ptr<const Effect> MakeEffect(const Config& config, const Effect* material = nullptr);

// The elasticity law that `{law: neo_hookean, young_modulus: 0.1 MPa, poisson_ratio: 0.3}`
// describes. Throws like MakeEffect.
std::shared_ptr<const Effect> MakeMaterial(const Config& config);

// An effect from parameters by name, SI; a parameter left out takes the card's default. A name that
// the catalogue or the card does not have, an effect that YAML alone describes, or a parameter
// without value, is our own mistake (CHECK).
std::shared_ptr<const Effect> MakeEffect(const std::string& type,
                                         const std::map<std::string, double>& parameters);

// The usual `make`, for a class that is made from its parameters.
template <typename Type>
std::shared_ptr<const Effect> MakeAs(const Eigen::VectorXd& parameters) {
  return std::make_shared<Type>(parameters);
}

// The usual `read`: each parameter of the card under its own name, but three that are called n_x,
// n_y and n_z as one vector, `n: [0, 0, 1]`. A vector without dimension is a direction: of any
// length, but not of length 0 (InputError). One that is left out has the card's default; without
// one, the value of the material's parameter of the same name.
Eigen::VectorXd ReadParameters(const EffectCard& card, const Config& config,
                               const Effect* material);

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_CATALOGUE_H_
