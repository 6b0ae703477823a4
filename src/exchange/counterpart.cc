#include "exchange/counterpart.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cctype>

#include "core/text_layout.h"

namespace lacuna {
namespace {

std::string ParameterLine(const PortableParameter& parameter) {
  const std::string value =
      fmt::format("{} = {} {}", parameter.name, fmt::join(parameter.values, ", "), parameter.unit);
  if (!parameter.fitted) return value + " (held)";
  const std::string interval =
      fmt::format("95 % interval {:.6g} to {:.6g}", parameter.low, parameter.high);
  if (!parameter.at_limit) return fmt::format("{} (fitted; {})", value, interval);
  return fmt::format("{} (fitted; at_limit {:.6g}, {})", value, *parameter.at_limit, interval);
}

std::vector<std::string> ProvenanceLines(const PortableModel& model) {
  std::vector<std::string> lines{
      fmt::format("Written by lacuna {} from the run {}", model.program_version, model.run),
      fmt::format("Experiment {}, recording {}", model.experiment, model.recording),
      "Units are SI: m, kg, s, N, Pa",
      fmt::format("Time 0 of the motion is {} s on the model's clock", model.start)};
  bool has_limit = false;
  for (const PortableParameter& parameter : model.parameters) {
    lines.push_back(ParameterLine(parameter));
    has_limit |= parameter.at_limit.has_value();
  }
  if (has_limit)
    lines.emplace_back(
        "The file has the fitted values, which belong to the elements and time steps of the fit; "
        "at_limit is the value with infinitely fine elements and time steps, and the interval is "
        "that of at_limit");
  return lines;
}

std::string WithoutDoubleHyphens(std::string text) {
  for (size_t at = 0; (at = text.find("--", at)) != std::string::npos;) text.erase(at, 1);
  return text;
}

}  // namespace

Counterparts Missing(const Counterparts& counterparts) {
  Counterparts missing;
  for (const Counterpart& counterpart : counterparts)
    if (counterpart.kind == Counterpart::Kind::kNone) missing.push_back(counterpart);
  return missing;
}

std::vector<std::string> CounterpartLines(const Counterparts& counterparts) {
  std::vector<std::string> lines;
  for (const auto& [part, kind, how] : counterparts)
    lines.push_back(fmt::format("{}: {}{}", part,
                                kind == Counterpart::Kind::kExact       ? ""
                                : kind == Counterpart::Kind::kConverted ? "converted: "
                                                                        : "none: ",
                                how));
  return lines;
}

std::string CommentText(std::string text) {
  for (char& letter : text)
    if (std::iscntrl(static_cast<unsigned char>(letter)) != 0) letter = ' ';
  return text;
}

std::string XmlCommentText(const std::string& text) {
  return WithoutDoubleHyphens(CommentText(text));
}

std::string FileComment(const PortableModel& model, const Counterparts& counterparts,
                        const std::string& prefix) {
  std::string text;
  const auto add = [&](const std::string& line) { text += Wrapped(line, prefix, prefix + "  "); };
  for (const std::string& line : ProvenanceLines(model)) add(line);
  add("The parts of the model:");
  for (const std::string& line : CounterpartLines(counterparts)) add(line);
  return text;
}

std::string XmlComment(const PortableModel& model, const Counterparts& counterparts) {
  return "<!--\n" + WithoutDoubleHyphens(FileComment(model, counterparts, "  ")) + "-->\n";
}

}  // namespace lacuna
