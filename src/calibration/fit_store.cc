#include "calibration/fit_store.h"

#include <fstream>
#include <system_error>
#include <utility>
#include <vector>

#include "core/atomic_file.h"
#include "record/calibration_record.h"

namespace lacuna {
namespace {

using nlohmann::json;

json ToJson(const Calibration& calibration) {
  json estimates = json::array();
  for (const ParameterEstimate& estimate : calibration.estimates)
    estimates.push_back(EstimateToJson(estimate));
  const Eigen::VectorXd& parameters = calibration.parameters;
  return {{"usable", calibration.usable},
          {"message", calibration.message},
          {"is_out_of_budget", calibration.is_out_of_budget},
          {"iterations", calibration.iterations},
          {"parameters", std::vector<double>(parameters.begin(), parameters.end())},
          {"estimates", estimates},
          {"predictions", calibration.predictions},
          {"start_rms", calibration.start_rms},
          {"rms", calibration.rms},
          {"cost", calibration.cost}};
}

Calibration FromJson(const json& value) {
  Calibration calibration;
  calibration.usable = value.at("usable");
  calibration.message = value.at("message");
  calibration.is_out_of_budget = value.at("is_out_of_budget");
  calibration.iterations = value.at("iterations");
  const std::vector<double> parameters = value.at("parameters");
  calibration.parameters = Eigen::Map<const Eigen::VectorXd>(
      parameters.data(), static_cast<Eigen::Index>(parameters.size()));
  for (const json& estimate : value.at("estimates"))
    calibration.estimates.push_back(EstimateFromJson(estimate));
  calibration.predictions = value.at("predictions");
  calibration.start_rms = value.at("start_rms");
  calibration.rms = value.at("rms");
  calibration.cost = value.at("cost");
  return calibration;
}

}  // namespace

FitStore::FitStore(std::filesystem::path file, json origin)
    : file_(std::move(file)), content_{{"schema_version", 1}, {"of", std::move(origin)}} {
  content_["fits"] = json::object();
  std::ifstream stream(file_);
  const json there = json::parse(stream, nullptr, /*allow_exceptions=*/false);
  if (!there.is_object() || there.value("of", json()) != content_.at("of")) return;
  try {
    for (const auto& [key, fit] : there.at("fits").items()) fits_[key] = FromJson(fit);
    content_ = there;
  } catch (const json::exception&) {
    fits_.clear();  // the file is damaged
  }
}

const Calibration* FitStore::Find(const std::string& key) const {
  const std::lock_guard lock(mutex_);
  const auto found = fits_.find(key);
  return found != fits_.end() ? &found->second : nullptr;
}

void FitStore::Keep(const std::string& key, const Calibration& calibration) {
  const std::lock_guard lock(mutex_);
  content_["fits"][key] = ToJson(calibration);
  WriteFileAtomically(file_, content_.dump() + "\n");
  fits_[key] = calibration;
}

Calibration FitStore::FindOrFit(const std::string& key, const std::function<Calibration()>& fit) {
  if (const Calibration* kept = Find(key)) return *kept;
  const Calibration calibration = fit();
  Keep(key, calibration);
  return calibration;
}

void FitStore::Drop() {
  std::error_code ignored;  // a file that remains is harmless: its origin is checked
  std::filesystem::remove(file_, ignored);
}

}  // namespace lacuna
