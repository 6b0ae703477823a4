// A sealed case: synthetic recordings of a soft bar whose true physics is kept from the diagnosis.
//
// A case is drawn from a seed. Its model lacks one or several hidden effects, or it is a control
// that lacks none. The bar lies along x, is clamped at x = 0, deflected by a hand at its free end
// and released. The case is kept in truth.json, which is opened only after the diagnosis.
#ifndef LACUNA_TRIALS_TRIAL_CASE_H_
#define LACUNA_TRIALS_TRIAL_CASE_H_

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/bounds.h"
#include "diagnosis/nuisance.h"
#include "fem/effect.h"

namespace lacuna {

inline constexpr double kTrialSpacing = 0.01;  // s, between two frames of a recording

// An effect that the truth has and the model lacks.
struct HiddenEffect {
  std::string type;
  std::map<std::string, double> parameters;  // all parameters of the card, SI, as hidden
  // The parameters that define its size. Empty for an effect without a size: a contact with a
  // plane, and an elasticity law, which replaces the law of the model.
  std::vector<std::string> amplitude;
  // The size as a multiple of the detectable size. An effect without a size changes the recording
  // by at least this multiple of the detectable change.
  double factor = 0;
};
std::shared_ptr<const Effect> MakeHidden(const HiddenEffect& hidden);
// Whether the hidden effect is an elasticity law.
bool IsLaw(const HiddenEffect& hidden);

// An effect that the model has too, but whose parameters it does not know.
struct ModelledEffect {
  std::string type;
  std::map<std::string, double> parameters;  // all parameters of the card, SI, as in the truth
  std::map<std::string, double> starts;      // those that are fitted, and where their fit starts
};

// The prior from which the true value of a fitted parameter is drawn, and with which it is fitted:
// normal, or normal in the logarithm for a parameter on a logarithmic scale. SI.
struct TrialPrior {
  std::string name;  // as in a fit: "young_modulus", "attached_mass.centre_x"
  std::string unit;
  double mean = 0, deviation = 0;
  bool log_scale = false;
  Bounds bounds = kAnyValue;  // of the card; the truth is drawn within them, as the fit stays there
};

// A load cell that measures the force of the clamp. Its offset and its delay are drawn for each
// recording from the priors with which they are fitted (trials/trial_load_cell.h).
struct TrialLoadCell {
  double deviation = 0;        // N, σ of the noise of one component
  double tare_deviation = 0;   // N, σ of the offset of one component
  double delay_deviation = 0;  // s, σ of the delay
};

enum class TrialGroup {
  kControl,      // nothing is hidden
  kHardControl,  // nothing is hidden, and the measurement has a fault
  kOneEffect,    // one effect is hidden
  kPair,         // two effects are hidden
  kRemoved,      // one effect is hidden and is not in the library of the diagnosis
  kIntervals,    // a draw of trials/interval_trials.h
};
// The name in files and reports, e.g. "hard_control", and the reverse, which throws InputError.
std::string TrialGroupName(TrialGroup group);
TrialGroup TrialGroupFromName(const std::string& name);

struct TrialCase {
  std::string name;
  TrialGroup group = TrialGroup::kControl;
  uint64_t seed = 0;
  int recordings = 1;
  bool is_scanned = false;  // observed by depth cameras instead of markers
  // The nuisance of a hard control, named as on its card (NuisanceTrial::control); empty where
  // there is none.
  std::string nuisance;
  std::vector<HiddenEffect> hidden;
  std::vector<ModelledEffect> modelled;
  std::vector<TrialPrior> priors;  // of the fit, where it has any; not in truth.json
  std::optional<TrialLoadCell> load_cell;

  // The following values are drawn from the seed.
  double young_modulus = 1e5, poisson_ratio = 0.42;  // Pa, –
  double damping = 0;                      // s, stiffness-proportional, typical of soft rubber
  Eigen::Vector3d size{0.08, 0.02, 0.02};  // m, size in the model
  Eigen::Vector3d true_size = size;        // m
  double element_volume = 4e-7;            // m³, of the model's largest element
  double true_element_volume = 8e-8;       // m³, of the truth's
  double true_step = 5e-4;                 // s, time step of the truth
  double clamp_error = 0;                  // m, along x
  std::vector<Eigen::Vector3d>
      hold_forces;                    // N, force of the hand before the release, per recording
  double noise = 1e-4;                // m, standard deviation of a marker's coordinate, or
                                      // along the ray of a depth camera
  double noise_correlation_time = 0;  // s

  bool Hides(const std::string& type) const;
  // The error in the experiment of a hard control; by default none.
  NuisanceTrial Disturbance() const;
};

// Draws everything that depends on the seed, except hidden effects.
TrialCase DrawCase(const std::string& name, TrialGroup group, uint64_t seed, int recordings,
                   bool is_scanned, const std::string& nuisance);

// Draws whether a case of this seed has a load cell, with the probability `share`, and its noise.
// Its numbers are drawn apart from all others, which do not depend on it.
std::optional<TrialLoadCell> DrawLoadCell(uint64_t seed, double share);

// Draws the place, direction and times of an effect from the seed, as its card prescribes. Its size
// is 1 unit of its parameter, with a plausible sign; the caller scales it. A plane of contact
// stands beside the bar, on the side to which it swings. `type` must be in the catalogue.
HiddenEffect DrawHidden(const std::string& type, const TrialCase& trial, uint64_t seed);

// The text of truth.json.
std::string TextOfCase(const TrialCase& trial);
// Write and read truth.json in a folder. Both throw InputError if the file cannot be used.
void WriteCase(const TrialCase& trial, const std::filesystem::path& folder);
TrialCase ReadCase(const std::filesystem::path& folder);

// Number (i, j) of a stream of standard normal draws; it depends on the seed of the case and on
// these three numbers alone.
double Gauss(const TrialCase& trial, uint64_t stream, uint64_t i, uint64_t j);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_TRIAL_CASE_H_
