// The formats into which a model can be exported.
#ifndef LACUNA_EXCHANGE_EXPORT_FORMAT_H_
#define LACUNA_EXCHANGE_EXPORT_FORMAT_H_

#include <map>
#include <string>
#include <vector>

#include "exchange/counterpart.h"

namespace lacuna {

// The texts of files, by file name.
using FileTexts = std::map<std::string, std::string>;

struct ExportFormat {
  std::string name;     // as on the command line
  std::string program;  // what reads it
  // What becomes of each part of the model.
  Counterparts (*counterparts)(const PortableModel& model) = nullptr;
  // The files. Parts without counterpart are left out. Throws InputError where nothing sensible can
  // be written.
  FileTexts (*files)(const PortableModel& model) = nullptr;
};

const std::vector<ExportFormat>& ExportFormats();

// Throws InputError, with a suggestion, where there is no such format.
const ExportFormat& FindExportFormat(const std::string& name);

}  // namespace lacuna

#endif  // LACUNA_EXCHANGE_EXPORT_FORMAT_H_
