// Keeps the finished parts of a fit or a diagnosis that is under way in a file, so that one that
// was stopped continues where it was.
//
// The file holds {"schema_version", "of": origin, "fits": {key: fit}}. Each fit is
// written as soon as it is finished. Find() and Keep() may be called from several threads.
#ifndef LACUNA_CALIBRATION_FIT_STORE_H_
#define LACUNA_CALIBRATION_FIT_STORE_H_

#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>

#include "fit/calibration.h"

namespace lacuna {

// All of a calibration is kept but its covariance, inflation and memory.
class FitStore {
 public:
  // Reads `file` if it has the same origin (what the whole is computed from). Otherwise,
  // and if the file is missing or damaged, the store starts empty.
  FitStore(std::filesystem::path file, nlohmann::json origin);

  // Null: no such fit was kept. `key`: a hash of everything that determines the fit.
  const Calibration* Find(const std::string& key) const;
  // Adds a fit and rewrites the file. Throws InputError if it cannot be written.
  void Keep(const std::string& key, const Calibration& calibration);
  // The kept fit or, where there is none, the result of `fit`, which is kept.
  Calibration FindOrFit(const std::string& key, const std::function<Calibration()>& fit);
  // Removes the file, once the result of the whole has been saved.
  void Drop();

 private:
  mutable std::mutex mutex_;
  std::filesystem::path file_;
  nlohmann::json content_;
  std::map<std::string, Calibration> fits_;
};

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_FIT_STORE_H_
