// An experiment that reconstructs: one recording, and the settings of every stage of the paper's
// pipeline. docs/experiment.md lists the keys.
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
#include "fem/simulate.h"
#include "fit/force_fit.h"
#include "registration/coherent_point_drift.h"
#include "scan/filter.h"
#include "scan/recording.h"
#include "surface/reconstruct.h"

namespace lacuna {

// Where unknown forces may act, and how they may vary (fit/force_model.h).
struct ForceSettings {
  enum class Kind { kNone, kKnown, kFree, kSmooth, kFootprint, kNodal };
  Kind kind = Kind::kSmooth;     // kKnown: the recording's measured forces, nothing is fitted
  std::optional<Region> region;  // absent: the whole boundary; a footprint needs one
  double length = 0;             // m, of smooth forces; 0: a quarter of the object's diagonal
  double traction_scale = 0;     // Pa, of smooth forces; 0: a tenth of Young's modulus
  double force_scale = 1;        // N, of a footprint or of each node
  bool hold_net_force = false;   // no net force, no net torque
  // Masses of the pseudo-acceleration forces (F = m α): the FEM's lumped ones, or 1 kg at each node
  // as in the paper.
  bool unit_pseudo_mass = false;
};

struct FollowSettings {
  TimeScheme scheme = TimeScheme::kImplicitEuler;
  bool allow_inverted =
      false;  // accept steps with inverted elements, as linear elasticity may need
  ForceSettings forces;
  ForceFitOptions fit;
  double noise = 0;  // m, standard deviation of a scanned point; 0: estimated
  // m, the least that a correspondence found by CPD is uncertain across the normal: points of two
  // scans have no partners, so that CPD slides along a surface without features by more than its
  // own deviation tells. 0: 3 % of the object's size. Larger: forces along the surface shrink.
  double tangential_noise = 0;
  int alignment_rounds = 3;  // correspondences are taken anew so often; more: slower, exacter
  // Scanned points farther than this from the simulated surface are somebody else's, in parts of
  // the object's size; larger: a worse start is forgiven, more foreign points are taken in.
  double reach = 0.1;
  // Of tracked points and markers: believe that row i is the same material point in every frame.
  // Otherwise correspondence comes from CPD.
  bool use_identity = true;
};

// Numbers known from elsewhere, against which a reconstruction is checked. Nothing of it enters the
// fit.
struct ValidationSettings {
  int hold_out_every = 0;  // every k-th tracked point is kept from the fit and predicted; 0: none
  std::filesystem::path true_surfaces;   // the truth/ folder of a virtual scan
  std::filesystem::path true_positions;  // .npy, frames × points × 3, m
  std::filesystem::path true_mesh;       // the tet mesh whose nodes these points are
  std::filesystem::path true_forces;     // .npy, frames × 3, N, the resultant
};

struct ReconstructionStudy {
  std::string name;
  std::filesystem::path output;
  Recording recording;
  std::vector<int> frames;  // of the recording, ascending
  uint64_t seed = 1;
  FilterOptions filter;
  SurfaceOptions surface;
  bool surfaces_of_frames = true;  // Poisson surface of each frame; else its points stand for it
  CpdOptions registration;
  MeshSettings mesh;
  int sheet_layers = 1;
  double density = 1000;  // kg/m³
  EffectList effects;
  FollowSettings follow;
  ValidationSettings validation;
  nlohmann::json configuration;  // resolved, SI
};

// Reads and checks everything that can be checked before the computation. Throws InputError.
ReconstructionStudy ReadReconstruction(const Config& config);
// The same for a given recording, which `config` then does not name; keys that the caller has read
// before count as known.
ReconstructionStudy ReadReconstruction(const Config& config, const Recording& recording);

}  // namespace lacuna

#endif  // LACUNA_RECONSTRUCTION_RECONSTRUCTION_STUDY_H_
