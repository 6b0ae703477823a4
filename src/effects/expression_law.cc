#include "effects/expression_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/quoted_text.h"
#include "core/random_bits.h"
#include "effects/effect_text.h"

namespace lacuna {
namespace {

using Law = ExpressionLaw;
using Measure = Law::Measure;

const char* const kVariableNames[Law::kVariables] = {"x",  "y",  "z",  "X",  "Y", "Z",  "ux", "uy",
                                                     "uz", "vx", "vy", "vz", "t", "nx", "ny", "nz"};

// `{value: 3 N/kg, plausible: [-10 N/kg, 10 N/kg], null_value: 0, min: …, max: …, log_scale: false,
// setting: false, meaning: …}`
ParameterCard ReadParameterCard(const Config& config, const std::string& name, double* value) {
  ParameterCard card;
  card.name = name;
  card.meaning = config.Text("meaning", "parameter of the law");
  card.dimension = config.AnyQuantity("value").dimension;
  card.setting = config.Flag("setting", false);
  card.log_scale = config.Flag("log_scale", false);
  if (config.Has("min")) card.bounds.min = config.Quantity("min", card.dimension, kAnyValue);
  if (config.Has("max")) card.bounds.max = config.Quantity("max", card.dimension, kAnyValue);
  if (!(card.bounds.min < card.bounds.max)) config.Fail("max", "expected a value above min");
  if (card.log_scale && card.bounds.min <= 0) {
    card.bounds.min = 0;
    card.bounds.open_min = true;
  }
  *value = config.Quantity("value", card.dimension, card.bounds);
  card.default_value = *value;
  card.null_value = config.Has("null_value")
                        ? config.Quantity("null_value", card.dimension, kAnyValue)
                        : kNoNullValue;
  const std::vector<double> plausible = config.Quantities("plausible", card.dimension, card.bounds);
  if (plausible.size() == 2 && plausible[0] < plausible[1]) {
    card.plausible_min = plausible[0];
    card.plausible_max = plausible[1];
  } else if (plausible.empty() && card.setting) {
    const double width = *value == 0 ? 1 : std::abs(*value);
    card.plausible_min = std::max(*value - width, card.bounds.min);
    card.plausible_max = std::min(*value + width, card.bounds.max);
  } else {
    const std::string unit = card.dimension.unit;
    config.Fail("plausible",
                fmt::format("expected the smallest and the largest plausible value, e.g. "
                            "[-10{0}, 10{0}]; a parameter with `setting: true`, which is never "
                            "fitted, needs none",
                            unit.empty() ? "" : " " + unit));
  }
  if (card.log_scale && card.plausible_min <= 0)
    config.Fail("plausible", "expected values > 0, because the scale is logarithmic");
  return card;
}

void ReadLawParameters(const Config& config, Law* law) {
  const Config list = config.Child("parameters");
  const std::vector<std::string> names = list.Keys();
  if (names.size() > Law::kMaxParameters)
    config.Fail("parameters", fmt::format("expected at most {}", Law::kMaxParameters));
  std::vector<double> values;
  std::vector<std::pair<std::string, size_t>> amplitudes;
  for (const std::string& name : names) {
    if (!Expression::IsName(name))
      list.Fail(name, "expected a name of letters, digits and underscores");
    const auto& reserved = Expression::ReservedNames();
    if (std::find(reserved.begin(), reserved.end(), name) != reserved.end() ||
        std::find(kVariableNames, kVariableNames + Law::kVariables, name) !=
            kVariableNames + Law::kVariables)
      list.Fail(name, "this name has another meaning in an expression");
    values.push_back(0);
    law->card.parameters.push_back(ReadParameterCard(list.Child(name), name, &values.back()));
    if (!law->card.parameters.back().setting) amplitudes.emplace_back(name, values.size() - 1);
  }
  if (amplitudes.empty()) {
    config.Fail("parameters",
                "expected at least one that is not a setting: the amplitude, with which the force "
                "vanishes");
  }
  const size_t amplitude = config.Choice("amplitude", amplitudes, amplitudes.front().first);
  auto& cards = law->card.parameters;
  std::rotate(cards.begin(), cards.begin() + static_cast<std::ptrdiff_t>(amplitude),
              cards.begin() + static_cast<std::ptrdiff_t>(amplitude) + 1);
  std::rotate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(amplitude),
              values.begin() + static_cast<std::ptrdiff_t>(amplitude) + 1);
  if (std::isnan(cards.front().null_value)) cards.front().null_value = 0;
  const Bounds& bounds = cards.front().bounds;
  if (!(cards.front().null_value >= bounds.min && cards.front().null_value <= bounds.max)) {
    list.Child(cards.front().name)
        .Fail("", fmt::format("the null value {:g} of the amplitude is out of its bounds",
                              cards.front().null_value));
  }
  law->parameters =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

void ReadForce(const Config& config, Law* law) {
  const std::vector<std::string> texts = config.Texts("force");
  if (texts.size() != 3) {
    config.Fail(
        "force",
        fmt::format("got {} entries; expected three expressions, e.g. [0, 0, \"-k * z\"], in "
                    "quotes where they have a comma",
                    texts.size()));
  }
  std::vector<std::string> names(kVariableNames, kVariableNames + Law::kVariables);
  for (const ParameterCard& parameter : law->card.parameters) names.push_back(parameter.name);
  for (size_t axis = 0; axis < 3; ++axis) {
    try {
      law->force.emplace_back(texts[axis], names);
    } catch (const ExpressionError& problem) {
      config.FailAtItem("force", axis, fmt::format("\"{}\", {}", texts[axis], problem.what()));
    }
  }
  for (size_t k = 0; k < law->card.parameters.size(); ++k) {
    if (std::none_of(law->force.begin(), law->force.end(),
                     [&](const Expression& force) { return force.Uses(Law::kVariables + k); })) {
      config.Child("parameters")
          .Fail(law->card.parameters[k].name, "does not occur in any of the three expressions");
    }
  }
}

// The diagnosis uses the derivative with respect to the amplitude at its null value, so there the
// law must vanish, but its derivative must not. Checked at random places, velocities and times of
// magnitudes up to 1 m, 1 m/s and 10 s.
void CheckAmplitude(const Config& config, const Law& law) {
  const ParameterCard& amplitude = law.card.parameters.front();
  const double farthest = std::abs(amplitude.plausible_max - amplitude.null_value) >
                                  std::abs(amplitude.plausible_min - amplitude.null_value)
                              ? amplitude.plausible_max
                              : amplitude.plausible_min;
  // The same on every platform, so that an experiment is accepted on all of them or on none.
  uint64_t drawn = 0;
  const auto uniform = [&drawn] { return 2 * Uniform(RandomBits({drawn++})) - 1; };
  bool acts = false, grows = false;
  for (int trial = 0; trial < 200; ++trial) {
    Law::Values<Dual<1>> values;
    const double size = std::pow(10.0, -(trial % 4));
    for (int k = 0; k < Law::kVariables; ++k) values[k] = Dual<1>::Constant(size * uniform());
    for (int axis = 0; axis < 3; ++axis)
      values[Law::kDisplacement + axis].value =
          values[Law::kPosition + axis].value - values[Law::kRest + axis].value;
    Eigen::Vector3d normal;
    for (double& component : normal) component = uniform();
    normal.normalize();
    for (int axis = 0; axis < 3; ++axis) values[Law::kNormal + axis].value = normal[axis];
    values[Law::kTime].value = 10 * std::abs(values[Law::kTime].value);
    for (Eigen::Index k = 0; k < law.parameters.size(); ++k)
      values[Law::kVariables + k] = Dual<1>::Constant(law.parameters[k]);
    for (size_t axis = 0; axis < 3; ++axis) {
      values[Law::kVariables] = Dual<1>::Constant(farthest);
      const double full = law.force[axis].At(values.data()).value;
      values[Law::kVariables] = Dual<1>::Variable(amplitude.null_value, 0);
      const Dual<1> null = law.force[axis].At(values.data());
      // A place where the law is undefined (NaN) is not an error here.
      if (std::abs(null.value) > 1e-12 * std::abs(full)) {
        config.FailAtItem(
            "force", axis,
            fmt::format("\"{}\" must vanish when {}, the amplitude, is {:g}, but is {:g} at {}",
                        law.force[axis].text(), amplitude.name, amplitude.null_value, null.value,
                        fmt::format("x = {:g}, y = {:g}, z = {:g}", values[0].value,
                                    values[1].value, values[2].value)));
      }
      acts = acts || (std::isfinite(full) && full != 0);
      grows = grows || !(null.derivative[0] == 0);
    }
  }
  if (acts && !grows) {
    config.Fail("force", fmt::format("must grow in proportion to {0}, the amplitude, where that is "
                                     "{1:g}, unlike {0}^2 or abs({0}): its derivative is 0 there",
                                     amplitude.name, amplitude.null_value));
  }
}

std::string FormatParameter(const ParameterCard& card, double value) {
  const auto quantity = [&](double number) { return FormatQuantity(number, card.dimension); };
  std::string text = "{value: " + quantity(value);
  if (card.setting)
    text += ", setting: true";
  else
    text += fmt::format(", plausible: [{}, {}]", quantity(card.plausible_min),
                        quantity(card.plausible_max));
  if (std::isfinite(card.bounds.min) && !card.bounds.open_min)
    text += ", min: " + quantity(card.bounds.min);
  if (std::isfinite(card.bounds.max)) text += ", max: " + quantity(card.bounds.max);
  if (!std::isnan(card.null_value)) text += ", null_value: " + quantity(card.null_value);
  if (card.log_scale) text += ", log_scale: true";
  return text + ", meaning: " + QuotedText(card.meaning) + "}";
}

}  // namespace

std::string FormatExpressionLaw(const ExpressionLaw& law) {
  const char* per = law.per == Measure::kMass     ? "mass"
                    : law.per == Measure::kVolume ? "volume"
                                                  : "area";
  std::string text = fmt::format(
      "{{type: {}, name: {}, per: {}, force: [{}, {}, {}], amplitude: {}, citation: {}, "
      "parameters: {{",
      law.card.type, QuotedText(law.name), per, QuotedText(law.force[0].text()),
      QuotedText(law.force[1].text()), QuotedText(law.force[2].text()),
      law.card.parameters.front().name, QuotedText(law.card.citation));
  for (size_t k = 0; k < law.card.parameters.size(); ++k)
    text += fmt::format(
        "{}{}: {}", k == 0 ? "" : ", ", law.card.parameters[k].name,
        FormatParameter(law.card.parameters[k], law.parameters[static_cast<Eigen::Index>(k)]));
  return text + "}}";
}

std::string ExpressionLaw::NameOf(int variable) const {
  return variable < kVariables ? kVariableNames[variable]
                               : card.parameters[static_cast<size_t>(variable - kVariables)].name;
}

ExpressionLaw ReadExpressionLaw(const Config& config, const EffectCard& card) {
  Law law;
  law.name = config.Text("name");
  law.per = config.Choice<Measure>(
      "per", {{"mass", Measure::kMass}, {"volume", Measure::kVolume}, {"area", Measure::kArea}});
  law.card = card;
  law.card.title = fmt::format("{}, a user-defined force law", law.name);
  law.card.citation = config.Text("citation", "given by the user; language: docs/expression.md");
  ReadLawParameters(config, &law);
  ReadForce(config, &law);
  const char* measure = law.per == Measure::kMass     ? "m_i"
                        : law.per == Measure::kVolume ? "V_i"
                                                      : "A_i";
  law.card.equation = fmt::format("f_i = {} ({}, {}, {})", measure, law.force[0].text(),
                                  law.force[1].text(), law.force[2].text());
  CheckAmplitude(config, law);
  return law;
}

}  // namespace lacuna
