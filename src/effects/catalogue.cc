#include "effects/catalogue.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "effects/free_fall.h"
#include "effects/vector_parameters.h"

namespace lacuna {

CatalogueEntry LinearElasticity();
CatalogueEntry CorotationalElasticity();
CatalogueEntry SaintVenantKirchhoff();
CatalogueEntry NeoHookean();
CatalogueEntry StrainStiffening();
CatalogueEntry FibreStiffness();
CatalogueEntry Inclusion();
CatalogueEntry StiffnessGradient();
CatalogueEntry ViscoelasticBranch();
CatalogueEntry ElastoplasticBranch();
CatalogueEntry Softening();
CatalogueEntry Swelling();
CatalogueEntry SwellingField();
CatalogueEntry ActiveContraction();
CatalogueEntry Gravity();
CatalogueEntry AttachedMass();
CatalogueEntry DensityGradient();
CatalogueEntry MassDamping();
CatalogueEntry StiffnessDamping();
CatalogueEntry Drag();
CatalogueEntry Pressure();
CatalogueEntry PointForce();
CatalogueEntry FollowerForce();
CatalogueEntry PlaneContact();
CatalogueEntry ElasticSupport();
CatalogueEntry SlippingSupport();
CatalogueEntry ExpressionForce();

const std::vector<CatalogueEntry>& Catalogue() {
  static const std::vector<CatalogueEntry> entries{
      LinearElasticity(),
      CorotationalElasticity(),
      SaintVenantKirchhoff(),
      NeoHookean(),
      // Further behaviour of the material.
      StrainStiffening(),
      FibreStiffness(),
      Inclusion(),
      StiffnessGradient(),
      ViscoelasticBranch(),
      ElastoplasticBranch(),
      Softening(),
      Swelling(),
      SwellingField(),
      ActiveContraction(),
      // Loads, inertia, damping and supports.
      Gravity(),
      AttachedMass(),
      DensityGradient(),
      MassDamping(),
      StiffnessDamping(),
      Drag(),
      Pressure(),
      PointForce(),
      FollowerForce(),
      PlaneContact(),
      ElasticSupport(),
      SlippingSupport(),
      // A force law that the user writes.
      ExpressionForce(),
  };
  return entries;
}

namespace {

std::shared_ptr<const Effect> MakeOfKind(CatalogueEntry::Kind kind, const std::string& key,
                                         const Config& config, const Effect* material,
                                         const std::optional<Eigen::Vector3d>& gravity) {
  std::vector<std::pair<std::string, const CatalogueEntry*>> choices;
  for (const CatalogueEntry& entry : Catalogue()) {
    if (entry.kind == kind) choices.emplace_back(entry.card->type, &entry);
  }
  const CatalogueEntry* entry = config.Choice(key, choices);
  if (entry->make_from_yaml != nullptr) return entry->make_from_yaml(config);
  return entry->make(entry->read(*entry->card, config, material, gravity));
}

// The values of omitted parameters: the default of the card, else the material's parameter of the
// same name, else NaN.
Eigen::VectorXd DefaultValues(const EffectCard& card, const Effect* material) {
  Eigen::VectorXd values(card.parameters.size());
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    values[k] = card.parameters[k].default_value;
    if (!std::isnan(values[k]) || material == nullptr) continue;
    const std::vector<ParameterCard>& offered = material->Card().parameters;
    for (size_t m = 0; m < offered.size(); ++m) {
      if (offered[m].name == card.parameters[k].name)
        values[k] = material->Parameters()[static_cast<Eigen::Index>(m)];
    }
  }
  return values;
}

Eigen::Vector3d ReadVector(const Config& config, const std::string& name,
                           const Dimension& dimension, const Eigen::Vector3d& default_value) {
  const Eigen::Vector3d vector = default_value.hasNaN()
                                     ? config.Vector(name, dimension)
                                     : config.Vector(name, dimension, default_value);
  if (dimension.SameAs(kDimensionless) && config.Has(name) && vector.norm() == 0) {
    config.Fail(name, "expected a direction other than 0");
  }
  return vector;
}

// The setting `gravity` of an added mass in a model with the gravity `model`.
Eigen::Vector3d ReadGravitySetting(const Config& config,
                                   const std::optional<Eigen::Vector3d>& model) {
  if (!model) {
    if (!config.Has(kGravitySetting))
      config.Fail(kGravitySetting,
                  "must be given in a model without gravity: [0, 0, 0] for a mass without weight, "
                  "or the acceleration of free fall if the reference shape was measured under it "
                  "and without the mass");
    return config.Vector(kGravitySetting, kAcceleration);
  }
  const Eigen::Vector3d given = config.Vector(kGravitySetting, kAcceleration, *model);
  if (given.isZero(0)) return given;
  if (!IsSameGravity(given, *model))
    config.Fail(kGravitySetting,
                fmt::format("the gravity of the model is [{:g}, {:g}, {:g}] m/s^2; leave out the "
                            "key, or give [0, 0, 0] for a mass whose weight is one of the known "
                            "forces",
                            model->x(), model->y(), model->z()));
  return *model;
}

}  // namespace

const CatalogueEntry* FindEntry(const std::string& type) {
  for (const CatalogueEntry& entry : Catalogue()) {
    if (entry.card->type == type) return &entry;
  }
  return nullptr;
}

std::vector<std::string> LookAlikesOf(const EffectCard& card) {
  const auto contains = [](const std::vector<std::string>& list, const std::string& type) {
    return std::find(list.begin(), list.end(), type) != list.end();
  };
  std::vector<std::string> types = card.look_alikes;
  for (const CatalogueEntry& other : Catalogue()) {
    if (contains(other.card->look_alikes, card.type) && !contains(types, other.card->type))
      types.push_back(other.card->type);
  }
  return types;
}

bool MayStandBeside(const EffectCard& one, const EffectCard& other) {
  const auto excludes = [](const EffectCard& card, const std::string& type) {
    return std::find(card.excludes.begin(), card.excludes.end(), type) != card.excludes.end();
  };
  if (one.type == other.type) return one.repeatable;
  return !excludes(one, other.type) && !excludes(other, one.type);
}

std::shared_ptr<const Effect> MakeEffect(const Config& config, const Effect* material,
                                         const std::optional<Eigen::Vector3d>& gravity) {
  return MakeOfKind(CatalogueEntry::Kind::kEffect, "type", config, material, gravity);
}

std::shared_ptr<const Effect> MakeMaterial(const Config& config) {
  return MakeOfKind(CatalogueEntry::Kind::kMaterial, "law", config, nullptr, std::nullopt);
}

std::shared_ptr<const Effect> MakeEffect(const std::string& type,
                                         const std::map<std::string, double>& parameters) {
  const CatalogueEntry* entry = FindEntry(type);
  CHECK(entry != nullptr) << "no effect is called " << type;
  CHECK(entry->make != nullptr) << type << " is made from YAML alone";
  Eigen::VectorXd values(entry->card->parameters.size());
  size_t named = 0;
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const ParameterCard& parameter = entry->card->parameters[k];
    const auto given = parameters.find(parameter.name);
    named += given != parameters.end();
    values[k] = given != parameters.end() ? given->second : parameter.default_value;
    CHECK(!std::isnan(values[k])) << type << " needs " << parameter.name;
  }
  CHECK_EQ(named, parameters.size()) << "a parameter that " << type << " does not have";
  return entry->make(values);
}

Eigen::VectorXd ReadParameters(const EffectCard& card, const Config& config, const Effect* material,
                               const std::optional<Eigen::Vector3d>& gravity) {
  Eigen::VectorXd values = DefaultValues(card, material);
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const ParameterCard& parameter = card.parameters[k];
    if (const std::string vector = VectorNameAt(card, k); !vector.empty()) {
      values.segment<3>(k) =
          vector == kGravitySetting
              ? ReadGravitySetting(config, gravity)
              : ReadVector(config, vector, parameter.dimension, values.segment<3>(k));
      k += 2;
    } else if (std::isnan(values[k])) {
      values[k] = config.Quantity(parameter.name, parameter.dimension, parameter.bounds);
    } else {
      values[k] = config.Quantity(parameter.name, parameter.dimension, parameter.bounds, values[k]);
    }
  }
  return values;
}

}  // namespace lacuna
