// An experiment with a reconstruction: one recording, and the settings of every stage of the
// paper's pipeline. docs/experiment.md lists the keys.
#ifndef LACUNA_RECONSTRUCTION_RECONSTRUCTION_STUDY_H_
#define LACUNA_RECONSTRUCTION_RECONSTRUCTION_STUDY_H_

#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/config.h"
#include "experiment/model_reader.h"
#include "fem/stepper.h"
#include "fit/force_fit.h"
#include "reconstruction/known_answers.h"
#include "registration/coherent_point_drift.h"
#include "scan/filter.h"
#include "scan/recording.h"
#include "surface/reconstruct.h"

namespace lacuna {

// Where unknown forces may act and how they may vary (fit/force_model.h).
struct ForceSettings {
  enum class Kind { kNone, kKnown, kFree, kSmooth, kFootprint, kNodal };
  Kind kind = Kind::kSmooth;     // kKnown: measured forces, nothing is fitted
  std::optional<Region> region;  // absent: whole boundary; needed for a footprint
  double length = 0;             // m, smooth forces; 0: a quarter of the object's diagonal
  double traction_scale = 0;     // Pa, smooth forces; 0: a tenth of Young's modulus
  double force_scale = 1;        // N, footprint or each node
  bool hold_net_force = false;   // restrict the forces to zero net force and net torque
  // The masses in the initial guess F = m α: 1 kg at each node, as in the paper, or the lumped
  // masses of the FEM.
  bool unit_pseudo_mass = false;

  bool AreFitted() const { return kind != Kind::kNone && kind != Kind::kKnown; }
};

struct FollowSettings {
  TimeScheme scheme = TimeScheme::kImplicitEuler;
  bool allow_inverted =
      false;  // accept steps with inverted elements, as linear elasticity may need
  ForceSettings forces;
  ForceFitOptions fit;
  // m, σ of a scanned point, or of a coordinate of a marker or tracked point that identifies
  // itself; 0: estimated (point_noise.h). Not used where no forces are fitted.
  double noise = 0;
  // m, a lower bound of the σ of a CPD correspondence along the surface. Points of two scans are
  // not the same material points, so that CPD slides along a featureless surface by more than its
  // own deviation suggests. 0: 3 % of the object's size. Larger: forces along the surface become
  // smaller.
  double tangential_noise = 0;
  // How often correspondences are searched for. More: slower, more accurate.
  int alignment_rounds = 3;
  // Scanned points farther than this from the simulated surface do not belong to the object, as a
  // fraction of its size. Larger: worse start values are tolerated, and more points of other
  // objects are used.
  double reach = 0.1;
  // For tracked points and markers: whether row i is the same material point in every frame.
  // Otherwise correspondences are found by CPD.
  bool use_identity = true;
};

struct ReconstructionStudy {
  std::string name;
  std::filesystem::path output;
  Recording recording;
  std::vector<int> frames;  // frames of the recording, ascending
  uint64_t seed = 1;
  FilterOptions filter;
  SurfaceOptions surface;
  // Whether a Poisson surface is reconstructed for each frame; else its points represent it.
  bool surfaces_of_frames = true;
  CpdOptions registration;
  MeshSettings mesh;
  int sheet_layers = 1;
  double density = 1000;  // kg/m³
  EffectList effects;
  FollowSettings follow;
  ValidationSettings validation;
  nlohmann::json configuration;  // with defaults resolved, in SI units
};

// Reads and checks everything that can be checked before the computation. Throws InputError.
ReconstructionStudy ReadReconstruction(const Config& config);
// The same for a given recording, in place of one that `config` names. Keys that the caller has
// read before are not reported as unknown.
ReconstructionStudy ReadReconstruction(const Config& config, const Recording& recording);

}  // namespace lacuna

#endif  // LACUNA_RECONSTRUCTION_RECONSTRUCTION_STUDY_H_
