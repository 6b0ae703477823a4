#include "report/gathered_run.h"

#include "record/json_vector.h"
#include "report/reported_run.h"

namespace lacuna {

namespace fs = std::filesystem;
using nlohmann::json;

json EmptyRun(const fs::path& folder, const std::string& kind) {
  return {{"name", RunName(folder)},
          {"folder", FromProject(folder, folder)},
          {"kind", kind},
          {"models", json::array()},
          {"ledger", nullptr},
          {"noise", nullptr},
          {"reconstruction", nullptr},
          {"table1", nullptr},
          {"ablation", nullptr},
          {"trials", nullptr},
          {"intervals", nullptr},
          {"notes", json::array()},
          {"provenance", nullptr}};
}

json Provenance(const Manifest& manifest, const std::vector<std::string>& commands) {
  return {{"program", "Lacuna " + manifest.program_version},
          {"libraries", manifest.library_versions},
          {"configuration", manifest.configuration},
          {"inputs", manifest.inputs},
          {"seed", manifest.seed},
          {"commands", commands}};
}

std::string FromProject(const fs::path& path, const fs::path& run) {
  const auto normal = [](const fs::path& any) { return fs::absolute(any).lexically_normal(); };
  return normal(path / ".").parent_path().lexically_proximate(normal(run / "../..") / "").string();
}

json TableToJson(const CsvTable& table) {
  json columns = json::object();
  for (const CsvColumn& column : table) columns[column.name] = VectorToJson(column.values);
  return columns;
}

}  // namespace lacuna
