// lacuna effects
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "app/commands.h"
#include "app/explain.h"
#include "effects/catalogue.h"

namespace lacuna {
namespace {

int Effects(const std::string& type) {
  if (!type.empty()) return Explain(type);
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
  auto type = std::make_shared<std::string>();
  effects->add_option("name", *type, "Describe this effect in full");
  effects->callback([command, type] { *command = [type] { return Effects(*type); }; });
}

}  // namespace lacuna
