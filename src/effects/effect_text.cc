#include "effects/effect_text.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <cmath>

#include "effects/catalogue.h"
#include "effects/vector_parameters.h"

namespace lacuna {
namespace {

bool CanBeWritten(const Eigen::VectorXd& values, const ParameterCard& parameter) {
  const bool is_direction = values.size() == 3 && parameter.dimension.SameAs(kDimensionless);
  return values.allFinite() && !(is_direction && values.norm() == 0);
}

}  // namespace

std::string FormatQuantity(double value, const Dimension& dimension) {
  const std::string unit = dimension.unit;
  return fmt::format("{}{}{}", value, unit.empty() ? "" : " ", unit);
}

std::optional<std::string> FormatEffect(const Effect& effect) {
  const EffectCard& card = effect.Card();
  const CatalogueEntry* entry = FindEntry(card.type);
  if (entry == nullptr) return std::nullopt;
  if (entry->format != nullptr) return entry->format(effect);
  CHECK(entry->make != nullptr) << card.type;
  const Eigen::VectorXd values = effect.Parameters();
  std::string text = fmt::format(
      "{{{}: {}", entry->kind == CatalogueEntry::Kind::kMaterial ? "law" : "type", card.type);
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const ParameterCard& parameter = card.parameters[k];
    const std::string vector = VectorNameAt(card, k);
    const Eigen::Index count = vector.empty() ? 1 : 3;
    const Eigen::VectorXd value = values.segment(k, count);
    if (CanBeWritten(value, parameter)) {
      std::string written = FormatQuantity(value[0], parameter.dimension);
      for (Eigen::Index i = 1; i < count; ++i)
        written += ", " + FormatQuantity(value[i], parameter.dimension);
      text += vector.empty() ? fmt::format(", {}: {}", parameter.name, written)
                             : fmt::format(", {}: [{}]", vector, written);
    } else {
      for (Eigen::Index i = 0; i < count; ++i)
        if (value[i] != card.parameters[k + i].default_value) return std::nullopt;
    }
    k += count - 1;
  }
  return text + "}";
}

}  // namespace lacuna
