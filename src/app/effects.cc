// lacuna effects
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "app/commands.h"
#include "effects/catalogue.h"

namespace lacuna {
namespace {

int Effects() {
  for (const auto kind : {CatalogueEntry::Kind::kMaterial, CatalogueEntry::Kind::kEffect}) {
    fmt::print("{}\n", kind == CatalogueEntry::Kind::kMaterial ? "material: {law: ...}"
                                                               : "effects: [{type: ...}]");
    for (const CatalogueEntry& entry : Catalogue())
      if (entry.kind == kind) fmt::print("  {:26} {}\n", entry.card->type, entry.card->title);
  }
  fmt::print("\nlacuna explain NAME describes one of them in full.\n");
  return 0;
}

}  // namespace

void AddEffects(CLI::App* app, std::function<int()>* command) {
  CLI::App* effects =
      app->add_subcommand("effects", "List the physical effects that a model can have");
  effects->callback([command] { *command = Effects; });
}

}  // namespace lacuna
