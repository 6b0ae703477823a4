// lacuna effects
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "app/commands.h"
#include "core/error.h"
#include "core/suggestion.h"
#include "effects/catalogue.h"

namespace lacuna {
namespace {

void PrintCard(const EffectCard& card) {
  fmt::print("{}  ({})\n  {}\n  source: {}\n", card.title, card.type, card.equation, card.citation);
  for (const ParameterCard& parameter : card.parameters) {
    fmt::print("  {:18} {}; {}, usually {:g} to {:g} {}", parameter.name, parameter.meaning,
               parameter.dimension.name, parameter.plausible_min, parameter.plausible_max,
               parameter.dimension.unit);
    if (!std::isnan(parameter.default_value)) fmt::print(", default {:g}", parameter.default_value);
    fmt::print("\n");
  }
  fmt::print("  when it is missing: {}\n  to tell it apart: {}\n", card.residual_when_missing,
             card.separating_experiment);
}

int Effects(const std::string& type) {
  if (!type.empty()) {
    const CatalogueEntry* entry = FindEntry(type);
    if (entry == nullptr) {
      std::vector<std::string> known;
      for (const CatalogueEntry& each : Catalogue()) known.push_back(each.card->type);
      throw InputError(fmt::format("no effect is called \"{}\"{}; `lacuna effects` lists them",
                                   type, Suggestion(type, known)));
    }
    PrintCard(*entry->card);
    return 0;
  }
  for (const auto kind : {CatalogueEntry::Kind::kMaterial, CatalogueEntry::Kind::kEffect}) {
    fmt::print("{}\n", kind == CatalogueEntry::Kind::kMaterial ? "material: {law: ...}"
                                                               : "effects: [{type: ...}]");
    for (const CatalogueEntry& entry : Catalogue())
      if (entry.kind == kind) fmt::print("  {:26} {}\n", entry.card->type, entry.card->title);
  }
  fmt::print("\nlacuna effects NAME tells one in full.\n");
  return 0;
}

}  // namespace

void AddEffects(CLI::App* app, std::function<int()>* command) {
  CLI::App* effects = app->add_subcommand("effects", "List the physics that a model can have");
  auto type = std::make_shared<std::string>();
  effects->add_option("name", *type, "Tell this one in full");
  effects->callback([command, type] { *command = [type] { return Effects(*type); }; });
}

}  // namespace lacuna
