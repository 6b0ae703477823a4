// lacuna explain
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <variant>

#include "app/commands.h"
#include "app/effect_examples.h"
#include "app/explain_nuisance.h"
#include "core/error.h"
#include "core/suggestion.h"
#include "core/text_layout.h"
#include "diagnosis/nuisance_catalogue.h"
#include "effects/catalogue.h"
#include "effects/effect_text.h"
#include "effects/gravity.h"
#include "effects/vector_parameters.h"

namespace lacuna {
namespace {

constexpr size_t kLineWidth = 96;  // characters

void PrintWrapped(const std::string& text, size_t indent) {
  const std::string margin(indent, ' ');
  if (!text.empty()) fmt::print("{}", Wrapped(text, margin, margin, kLineWidth));
}

void PrintSection(const std::string& heading, const std::string& text) {
  fmt::print("\n{}\n", heading);
  PrintWrapped(text, 2);
}

const CatalogueEntry& RequireEntry(const std::string& type) {
  if (const CatalogueEntry* entry = FindEntry(type)) return *entry;
  std::vector<std::string> known;
  for (const CatalogueEntry& each : Catalogue()) known.push_back(each.card->type);
  throw InputError(fmt::format("no effect is called \"{}\"{}; `lacuna effects` lists them", type,
                               Suggestion(type, known)));
}

bool IsOfMaterials(const std::string& parameter) {
  return std::any_of(Catalogue().begin(), Catalogue().end(), [&](const CatalogueEntry& entry) {
    const auto& cards = entry.card->parameters;
    return entry.kind == CatalogueEntry::Kind::kMaterial &&
           std::any_of(cards.begin(), cards.end(),
                       [&](const ParameterCard& card) { return card.name == parameter; });
  });
}

std::string InUnit(const std::string& numbers, const Dimension& dimension) {
  const std::string unit = dimension.unit;
  return numbers + (unit.empty() ? "" : " " + unit);
}

bool IsDirection(const ParameterCard& parameter, size_t count) {
  return count == 3 && parameter.dimension.SameAs(kDimensionless);
}

// The default of parameter `k` of the card or, where `count` is 3, of the vector that starts there.
std::string DefaultText(const CatalogueEntry& entry, size_t k, size_t count) {
  const ParameterCard& first = entry.card->parameters[k];
  if (static_cast<int>(k) == GravitySettingOn(*entry.card)) return "default: the model's";
  if (std::isnan(first.default_value)) {
    const bool from_material =
        entry.kind == CatalogueEntry::Kind::kEffect && IsOfMaterials(first.name);
    return from_material ? "default: the material's" : "must be given";
  }
  std::string numbers;
  bool is_zero = true;
  for (size_t i = k; i < k + count; ++i) {
    const double value = entry.card->parameters[i].default_value;
    numbers += fmt::format("{}{:g}", i > k ? ", " : "", value);
    is_zero = is_zero && value == 0;
  }
  if (IsDirection(first, count) && is_zero) return "default: none";
  return "default " + InUnit(count > 1 ? "[" + numbers + "]" : numbers, first.dimension);
}

// The meaning of a vector, from that of its first component: "direction of the pull" from
// "direction of the pull along x".
std::string OfWholeVector(const std::string& meaning) {
  std::string common = meaning;
  const std::string component = " along x";
  if (common.ends_with(component)) common.resize(common.size() - component.size());
  while (common.ends_with(',') || common.ends_with(';')) common.pop_back();
  return common;
}

// Dimension, usual range, default and use in fits of the same parameter or vector.
std::string Facts(const CatalogueEntry& entry, size_t k, size_t count) {
  const ParameterCard& parameter = entry.card->parameters[k];
  std::string facts = parameter.dimension.name;
  if (IsDirection(parameter, count)) {
    facts = "a direction";
  } else {
    if (count > 1) facts += " for each axis";
    facts += ", usually " +
             InUnit(fmt::format("{:g} to {:g}", parameter.plausible_min, parameter.plausible_max),
                    parameter.dimension);
    if (parameter.of_body)
      facts += fmt::format(", in proportion to {}", BodyUnitText(parameter.dimension));
  }
  facts += "; " + DefaultText(entry, k, count);
  if (parameter.setting) return facts + "; a setting, which is given and never fitted";
  facts += "; can be fitted";
  if (parameter.log_scale) facts += ", on a logarithmic scale";
  if (!std::isnan(parameter.null_value))
    facts += fmt::format("; no effect at {:g}", parameter.null_value);
  return facts;
}

void PrintParameters(const CatalogueEntry& entry) {
  const std::vector<ParameterCard>& parameters = entry.card->parameters;
  fmt::print("\nParameters\n");
  if (std::any_of(parameters.begin(), parameters.end(),
                  [](const ParameterCard& parameter) { return parameter.of_body; }))
    PrintWrapped(
        fmt::format(
            "Usual ranges that are in proportion to E, ρ or L are those in a body with Young's "
            "modulus E = {:g} Pa, density ρ = {:g} kg/m³ and length L = {:g} m.",
            kReferenceBody.young_modulus, kReferenceBody.density, kReferenceBody.length),
        2);
  if (parameters.empty()) PrintWrapped("User-defined, as docs/expression.md describes.", 2);
  for (size_t k = 0; k < parameters.size();) {
    const std::string vector = VectorNameAt(*entry.card, k);
    const size_t count = vector.empty() ? 1 : 3;
    fmt::print("  {}\n", vector.empty() ? parameters[k].name : vector + ": [x, y, z]");
    PrintWrapped(count > 1 ? OfWholeVector(parameters[k].meaning) : parameters[k].meaning, 6);
    PrintWrapped(Facts(entry, k, count), 6);
    k += count;
  }
}

std::string Invariances(const EffectCard& card) {
  if (card.conserves_momentum && card.conserves_angular_momentum)
    return "Internal: its forces and torques sum to zero, so it neither moves nor turns a free "
           "body.";
  if (card.conserves_momentum)
    return "Its forces sum to zero, so it does not move the centre of mass of a free body; its "
           "torques need not sum to zero.";
  return "An external load: its forces need not sum to zero.";
}

// Which variants of the effect a diagnosis tries.
std::string TriedAtText(const CatalogueEntry& entry) {
  if (entry.kind == CatalogueEntry::Kind::kMaterial)
    return "Tried in place of the elasticity law of the model, with the same moduli.";
  if (entry.is_own_law) return "Tried if the experiment lists the law among its candidates.";
  if (entry.make == nullptr)
    return "Not tried, because a part of it is an expression, which you choose.";
  struct Text {
    std::string operator()(const TriedOnce&) const { return "Tried once."; }
    std::string operator()(const TriedAtPlaces& places) const {
      return fmt::format(
          "Tried at {} places along the length of a bar, or spread over the volume of any other "
          "body.",
          places.length_shares.size());
    }
    std::string operator()(const TriedAlongDirections&) const {
      return "Tried along the principal axes of the body and the diagonals between them.";
    }
    std::string operator()(const TriedAsGradients&) const {
      return "Tried along the length of a bar, or along the two longest axes of any other body.";
    }
    std::string operator()(const TriedAtValues& values) const {
      return fmt::format("Tried at {} = {:g}.", values.parameter, fmt::join(values.values, ", "));
    }
    std::string operator()(const TriedAtRelaxationTimes& times) const {
      return "Tried at values of " + times.parameter +
             " between the time step of the simulation and the duration of the recordings.";
    }
    std::string operator()(const TriedAsSupports& supports) const {
      const std::string girth =
          "Tried on the whole surface, around the girth near both ends and at the middle of the "
          "length, and ";
      const std::string sides =
          "on each side of the body that faces along ±x, ±y or ±z and is not "
          "gripped: ";
      return girth + sides +
             (supports.slip_shares.empty()
                  ? "the whole side and three places along a long one. A refit moves the place "
                    "along the side and changes its radius."
                  : "the whole side; each at several slip distances.");
    }
    std::string operator()(const TriedAtContactPlanes&) const {
      return "Tried at planes that the predicted body crosses and the measured one does not.";
    }
  };
  return std::visit(Text(), entry.card->tried_at);
}

// The default or, where there is none, the middle of the plausible range, rounded to two digits.
double Typical(const ParameterCard& parameter) {
  if (!std::isnan(parameter.default_value)) return parameter.default_value;
  const double low = parameter.plausible_min, high = parameter.plausible_max;
  const double middle = parameter.log_scale && low > 0 ? std::sqrt(low * high) : 0.5 * (low + high);
  return std::stod(fmt::format("{:.2g}", middle));
}

// An example in YAML and where it comes from: the first file of configs/effects about the effect
// or, where there is none, typical parameter values.
struct Snippet {
  std::string origin;
  std::string yaml;
};

Snippet SnippetOf(const CatalogueEntry& entry) {
  for (const EffectExample& example : EffectExamples()) {
    if (Config::Parse(example.text, example.file).Text("type") != entry.card->type) continue;
    Snippet snippet{fmt::format("configs/effects/{}", example.file), ""};
    std::istringstream lines(example.text);
    bool begun = false;
    for (std::string line; std::getline(lines, line);) {
      const bool comment = line.starts_with('#');
      snippet.yaml += (begun ? "    " : comment ? "  " : "  - ") + line + "\n";
      begun = begun || !comment;
    }
    snippet.yaml = "effects:\n" + snippet.yaml;
    return snippet;
  }
  Eigen::VectorXd values(entry.card->parameters.size());
  for (Eigen::Index k = 0; k < values.size(); ++k) values[k] = Typical(entry.card->parameters[k]);
  const std::string text = FormatEffect(*entry.make(values)).value();
  const bool is_material = entry.kind == CatalogueEntry::Kind::kMaterial;
  return {"with values in the middle of the usual ranges",
          is_material ? "material: " + text + "\n" : "effects:\n  - " + text + "\n"};
}

int Explain(const std::string& type) {
  if (const NuisanceCard* nuisance = FindNuisance(type)) return ExplainNuisance(*nuisance);
  const CatalogueEntry& entry = RequireEntry(type);
  const EffectCard& card = *entry.card;
  fmt::print("{}  ({})\n", card.title, card.type);
  PrintSection("Equation", card.equation);
  PrintSection("Source", card.citation);
  PrintParameters(entry);
  PrintSection("When it is missing", card.residual_when_missing);
  PrintSection("How to distinguish it", card.separating_experiment + ".");
  if (const auto look_alikes = LookAlikesOf(card); !look_alikes.empty()) {
    fmt::print("\nEasily mistaken for\n");
    for (const std::string& other : look_alikes)
      fmt::print("  {:22} {}\n", other, FindEntry(other)->card->title);
  }
  PrintSection("In a diagnosis", TriedAtText(entry));
  PrintSection("Invariances",
               Invariances(card) + (card.repeatable ? " A model may have several of them." : ""));
  const Snippet snippet = SnippetOf(entry);
  fmt::print("\nExample ({})\n{}", snippet.origin, snippet.yaml);
  return 0;
}

}  // namespace

void AddExplain(CLI::App* app, std::function<int()>* command) {
  CLI::App* explain = app->add_subcommand("explain", "Describe one effect in full");
  auto type = std::make_shared<std::string>();
  explain->add_option("effect", *type, "Name of the effect, as `lacuna effects` lists it")
      ->required();
  explain->callback([command, type] { *command = [type] { return Explain(*type); }; });
}

}  // namespace lacuna
