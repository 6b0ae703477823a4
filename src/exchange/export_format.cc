#include "exchange/export_format.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.h"
#include "core/suggestion.h"
#include "exchange/inp_writer.h"

namespace lacuna {

const std::vector<ExportFormat>& ExportFormats() {
  static const std::vector<ExportFormat> formats{
      {"inp", "CalculiX",
       [](const PortableModel& model) { return InpCounterparts(model, InpDialect::kCalculix); },
       [](const PortableModel& model) {
         return FileTexts{{"model.inp", InpText(model, InpDialect::kCalculix)}};
       }},
      {"abaqus", "Abaqus",
       [](const PortableModel& model) { return InpCounterparts(model, InpDialect::kAbaqus); },
       [](const PortableModel& model) {
         return FileTexts{{"model.inp", InpText(model, InpDialect::kAbaqus)}};
       }},
  };
  return formats;
}

const ExportFormat& FindExportFormat(const std::string& name) {
  std::vector<std::string> names;
  for (const ExportFormat& format : ExportFormats()) {
    if (format.name == name) return format;
    names.push_back(format.name);
  }
  throw InputError(fmt::format("there is no format \"{}\"{}; the formats: {}", name,
                               Suggestion(name, names), fmt::join(names, ", ")));
}

}  // namespace lacuna
