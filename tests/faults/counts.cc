#include "faults/counts.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/error.h"
#include "support/temporary_folder.h"

namespace lacuna {

FaultCounts::FaultCounts(const std::filesystem::path& file, const std::string& identity)
    : file_(file) {
  std::string text = std::filesystem::exists(file) ? FileContent(file) : "";
  const size_t whole = text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1;
  if (whole < text.size()) std::filesystem::resize_file(file, whole);
  text.resize(whole);
  if (text.empty()) {
    WriteLine(nlohmann::json{{"faults", identity}}.dump());
    return;
  }
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    try {
      const nlohmann::json json = nlohmann::json::parse(line);
      if (number == 1) {
        if (json.at("faults") == identity) continue;
        throw InputError({file.string(), 1},
                         "was made with another program or seed; choose another folder");
      }
      outcomes_[json.at("trial")] = {json.at("failure"), json.at("note"),
                                     json.at("hidden_at_fault"), json.at("hidden_at_end")};
    } catch (const nlohmann::json::exception& problem) {
      throw InputError({file.string(), number}, problem.what());
    }
  }
}

const TrialOutcome* FaultCounts::Find(const std::string& trial) const {
  const auto found = outcomes_.find(trial);
  return found == outcomes_.end() ? nullptr : &found->second;
}

const TrialOutcome& FaultCounts::Append(const std::string& trial, const TrialOutcome& outcome) {
  const nlohmann::json json{{"trial", trial},
                            {"failure", outcome.failure},
                            {"note", outcome.note},
                            {"hidden_at_fault", outcome.hidden_at_fault},
                            {"hidden_at_end", outcome.hidden_at_end}};
  WriteLine(json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  return outcomes_[trial] = outcome;
}

void FaultCounts::WriteLine(const std::string& line) {
  std::ofstream stream(file_, std::ios::app);
  stream << line << "\n" << std::flush;
  if (!stream) throw InputError({file_.string()}, "cannot be written");
}

}  // namespace lacuna
