// The fits of a diagnosis under way, kept one by one: one that was stopped goes on where it was.
#ifndef LACUNA_DIAGNOSIS_REFIT_STORE_H_
#define LACUNA_DIAGNOSIS_REFIT_STORE_H_

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "fit/calibration.h"

namespace lacuna {

// Of each fit what a refit makes use of: whether it is usable and why not, its parameters, their
// estimates, the rms misfit that it leaves.
class RefitStore {
 public:
  // Goes on with what `file` has where that is of the same origin; else with nothing.
  RefitStore(std::filesystem::path file, nlohmann::json origin);

  // Null: there is none. `key`: a hash of all that decides it.
  const Calibration* Find(const std::string& key) const;
  // Writes the file anew. Throws InputError when it cannot be written.
  void Keep(const std::string& key, const Calibration& calibration);
  // All is told elsewhere: the file goes.
  void Drop();

 private:
  std::filesystem::path file_;
  nlohmann::json content_;
  std::map<std::string, Calibration> fits_;
};

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_REFIT_STORE_H_
