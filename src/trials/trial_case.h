// A sealed case: a recording of a soft bar whose physics is known to its maker alone.
#ifndef LACUNA_TRIALS_TRIAL_CASE_H_
#define LACUNA_TRIALS_TRIAL_CASE_H_

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "diagnosis/nuisance.h"
#include "fem/effect.h"

namespace lacuna {

// An effect that the truth has and the model lacks.
struct HiddenEffect {
  std::string type;
  std::map<std::string, double> parameters;  // all of the card's, SI, at the size that is hidden
  // Those that make its size; none where nothing does: of a plane that is met, or of an elasticity
  // law, which stands in the place of the model's.
  std::vector<std::string> amplitude;
  double factor = 0;  // of its detectable size; without a size: what it changes is that many times
                      // what can be detected, or more
};
std::shared_ptr<const Effect> MakeHidden(const HiddenEffect& hidden);
bool IsLaw(const HiddenEffect& hidden);
// What the model has of itself, unless it is what is hidden.
bool IsKnown(const std::string& type);

struct TrialCase {
  std::string name;
  // "control", "hard_control", "one_effect", "pair" or "removed": the last hides an effect that the
  // library is then not allowed to name.
  std::string group;
  uint64_t seed = 0;
  int recordings = 1;
  bool is_scanned = false;  // by depth cameras; else markers are tracked
  // NuisanceTrial::control of the nuisance that a hard control has; empty: none.
  std::string nuisance;
  std::vector<HiddenEffect> hidden;

  // Drawn from the seed.
  double young_modulus = 1e5, poisson_ratio = 0.42;  // Pa, –
  double damping = 0;                                // s, of the stiffness, as soft rubber has it
  Eigen::Vector3d size{0.08, 0.02, 0.02};            // m, as the model has it
  Eigen::Vector3d true_size = size;                  // m
  double clamp_error = 0;                            // m
  std::vector<Eigen::Vector3d> hold_forces;          // N, per recording
  double noise = 1e-4;                // m, of a marker's coordinate or along a depth camera's ray
  double noise_correlation_time = 0;  // s

  bool Hides(const std::string& type) const;
  // What is wrong with the experiment of a hard control; by default nothing.
  NuisanceTrial Disturbance() const;
};

// Without a hidden effect yet.
TrialCase DrawCase(const std::string& name, const std::string& group, uint64_t seed, int recordings,
                   bool is_scanned, const std::string& nuisance);

// An effect with places, directions and times drawn from the seed, of size 1 in its plausible
// direction; the factor is still to be applied. A plane lies beside the bar, on the side to which
// it swings.
HiddenEffect DrawHidden(const std::string& type, const TrialCase& trial, uint64_t seed);

// truth.json
void SaveCase(const TrialCase& trial, const std::filesystem::path& file);
TrialCase LoadCase(const std::filesystem::path& file);

// The folders of a suite's cases, by name. Throws InputError where there is no such folder.
std::vector<std::filesystem::path> CasesIn(const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_TRIAL_CASE_H_
