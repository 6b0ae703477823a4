#include "reconstruction/reconstruction_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "experiment/frame_states.h"
#include "experiment/listed_regions.h"
#include "experiment/scan_settings.h"
#include "geometry/mesh_io.h"
#include "reconstruction/point_noise.h"

namespace lacuna {
namespace {

CpdOptions ReadRegistration(const Config& config) {
  CpdOptions cpd;
  cpd.beta = config.Number("beta", kPositive, cpd.beta);
  cpd.fine_variance = config.Number("fine_variance", kNotNegative, cpd.fine_variance);
  cpd.lambda = config.Number("lambda", kPositive, cpd.lambda);
  cpd.rigidity = config.Number("rigidity", kNotNegative, cpd.rigidity);
  cpd.tangential_weight =
      config.Number("tangential_weight", {0, 1, true, false}, cpd.tangential_weight);
  cpd.match_extents = config.Flag("match_extents", cpd.match_extents);
  cpd.outlier_weight =
      config.Number("outlier_weight", {CpdOptions::kFewestOutliers, CpdOptions::kMostOutliers},
                    cpd.outlier_weight);
  cpd.estimate_outlier_weight = config.Flag("estimate_outlier_weight", cpd.estimate_outlier_weight);
  cpd.initial_sigma = config.Quantity("initial_sigma", kLength, kNotNegative, cpd.initial_sigma);
  cpd.sigma_floor = config.Number("sigma_floor", kPositive, cpd.sigma_floor);
  cpd.points_per_function =
      config.Integer("points_per_function", 1, 100000, cpd.points_per_function);
  cpd.max_rank = config.Integer("max_rank", 4, 2000, cpd.max_rank);
  cpd.rank_tolerance = config.Number("rank_tolerance", {0, 1, true, false}, cpd.rank_tolerance);
  return cpd;
}

ForceSettings ReadForces(const Config& config, const std::filesystem::path& data_folder) {
  using Kind = ForceSettings::Kind;
  ForceSettings forces;
  forces.kind = config.Choice<Kind>("model",
                                    {{"none", Kind::kNone},
                                     {"known", Kind::kKnown},
                                     {"free", Kind::kFree},
                                     {"smooth", Kind::kSmooth},
                                     {"footprint", Kind::kFootprint},
                                     {"nodal", Kind::kNodal}},
                                    "smooth");
  if (const auto region = config.OptionalChild("region"))
    forces.region = ReadRegion(*region, data_folder, "forces");
  if ((forces.kind == Kind::kFootprint || forces.kind == Kind::kNodal) && !forces.region)
    config.Fail("model", "needs a region");
  forces.length = config.Quantity("length", kLength, kNotNegative, forces.length);
  forces.traction_scale =
      config.Quantity("traction_scale", kPressure, kNotNegative, forces.traction_scale);
  forces.force_scale = config.Quantity("force_scale", kForce, kPositive, forces.force_scale);
  forces.unit_pseudo_mass =
      config.Choice<bool>("pseudo_mass", {{"lumped", false}, {"unit", true}}, "lumped");
  forces.hold_net_force = config.Flag("hold_net_force", forces.hold_net_force);
  if (forces.hold_net_force && forces.kind == Kind::kFree)
    config.Fail("hold_net_force",
                "needs smooth forces; free forces have no basis that could be restricted");
  if (forces.hold_net_force && forces.kind == Kind::kFootprint)
    config.Fail("hold_net_force",
                "leaves no force of a footprint, which is one net force; choose smooth forces");
  return forces;
}

FollowSettings ReadFollow(const Config& config, const std::filesystem::path& data_folder) {
  FollowSettings follow;
  if (const auto motion = config.OptionalChild("motion")) {
    follow.scheme = ReadTimeScheme(*motion, "implicit_euler");
    follow.allow_inverted = motion->Flag("allow_inverted", follow.allow_inverted);
  }
  if (const auto forces = config.OptionalChild("forces"))
    follow.forces = ReadForces(*forces, data_folder);
  if (const auto fit = config.OptionalChild("fit")) {
    follow.noise = fit->Quantity("noise", kLength, kNotNegative, follow.noise);
    follow.tangential_noise =
        fit->Quantity("tangential_noise", kLength, kNotNegative, follow.tangential_noise);
    follow.alignment_rounds = fit->Integer("alignment_rounds", 1, 50, follow.alignment_rounds);
    follow.use_identity = fit->Flag("use_identity", follow.use_identity);
    follow.reach = fit->Number("reach", {0, 1, true, false}, follow.reach);
    follow.fit.free_force_scale =
        fit->Quantity("free_force_scale", kLength, kPositive, follow.fit.free_force_scale);
    follow.fit.balance_tolerance =
        fit->Quantity("balance_tolerance", kLength, kPositive, follow.fit.balance_tolerance);
    follow.fit.robust_threshold =
        fit->Number("robust_threshold", kNotNegative, follow.fit.robust_threshold);
    follow.fit.max_iterations = fit->Integer("max_iterations", 1, 1000, follow.fit.max_iterations);
  }
  return follow;
}

// Warns of keys that have no effect with the model of the forces or the kind of the frames. They
// are not refused, because sweeps and experiments that build on others change the model alone.
void WarnOfIgnoredKeys(const Config& config, ReconstructionStudy* study) {
  using Kind = ForceSettings::Kind;
  std::vector<std::string>& warnings = study->recording.warnings;
  if (const auto forces = config.OptionalChild("forces")) {
    const Kind kind = study->follow.forces.kind;
    const auto warn = [&](const char* key, bool acts, const char* models) {
      if (forces->Has(key) && !acts)
        warnings.push_back(fmt::format("forces.{} has no effect with forces.model {}, only with {}",
                                       key, forces->Text("model", "smooth"), models));
    };
    warn("length", kind == Kind::kSmooth, "smooth");
    warn("traction_scale", kind == Kind::kSmooth, "smooth");
    warn("force_scale", kind == Kind::kFootprint || kind == Kind::kNodal, "footprint and nodal");
    warn("hold_net_force", kind == Kind::kSmooth || kind == Kind::kNodal, "smooth and nodal");
  }
  if (const auto fit = config.OptionalChild("fit"); fit && !IsScan(study->recording))
    for (const char* key : {"tangential_noise", "reach"})
      if (fit->Has(key))
        warnings.push_back(
            fmt::format("fit.{} has no effect on markers and tracked points, only on scans", key));
}

std::vector<int> ReadFrames(const Config& config, const Recording& recording) {
  const int count = recording.FrameCount();
  int first = 0, last = count - 1, every = 1;
  if (const auto frames = config.OptionalChild("frames")) {
    first = frames->Integer("first", 0, count - 1, first);
    last = frames->Integer("last", first, count - 1, last);
    every = frames->Integer("every", 1, count, every);
  }
  std::vector<int> chosen;
  for (int frame = first; frame <= last; frame += every) chosen.push_back(frame);
  return chosen;
}

// Reads the known answers once, so that a file that is missing or has the wrong shape is reported
// before the computation rather than after it.
void CheckKnownAnswers(const Config& entry, const ReconstructionStudy& study) {
  const ValidationSettings& validation = study.validation;
  const std::vector<int>& frames = study.frames;
  const auto check = [&entry](const char* key, const std::filesystem::path& path,
                              const auto& read) {
    if (path.empty()) return;
    if (!std::filesystem::exists(path)) entry.Fail(key, "there is no " + path.string());
    try {
      read();
    } catch (const InputError& problem) {
      entry.Fail(key, problem.what());
    }
  };
  check("true_surfaces", validation.true_surfaces, [&] {
    if (validation.true_surfaces.filename() != "truth")
      throw InputError("expected the folder `truth` of a simulated recording");
    for (const int frame : frames) ReadTrueSurface(validation, frame);
  });
  Eigen::Matrix3Xd first, last;  // the points of these frames
  if (!validation.true_mesh.empty()) {
    first = LoadFrame(study.recording, frames.front()).cloud.points;
    last = LoadFrame(study.recording, frames.back()).cloud.points;
  }
  check("true_mesh", validation.true_mesh, [&] {
    RequireLengthUnit(validation.true_mesh, ReadTetMesh(validation.true_mesh).mesh.nodes, first);
  });
  check("true_positions", validation.true_positions, [&] {
    const TruePositions truth = ReadTruePositions(validation, frames);
    RequireLengthUnit(validation.true_positions, truth.At(frames.front()), first);
    RequireLengthUnit(validation.true_positions, truth.At(frames.back()), last);
  });
  check("true_forces", validation.true_forces, [&] { ReadTrueForces(validation, frames); });
}

void RequireHeldOutPoints(const Config& entry, const Recording& recording, int hold_out_every) {
  if (hold_out_every == 0) return;
  if (IsScan(recording))
    entry.Fail(
        "hold_out_every",
        "needs markers or tracked points; the points of scans are not the same in all frames");
  if (SplitRows(recording, recording.row_count, hold_out_every).held_out.empty())
    entry.Fail("hold_out_every",
               fmt::format("holds out none of the {} tracked points: there are too few, or grips "
                           "follow those that it selects",
                           recording.row_count));
}

void ReadValidation(const Config& config, ReconstructionStudy* study) {
  const auto entry = config.OptionalChild("validation");
  if (!entry) return;
  ValidationSettings& validation = study->validation;
  validation.hold_out_every = entry->Integer("hold_out_every", 0, 1000000, 0);
  if (validation.hold_out_every == 1) entry->Fail("hold_out_every", "would hold out every point");
  RequireHeldOutPoints(*entry, study->recording, validation.hold_out_every);
  validation.true_surfaces = entry->Path("true_surfaces", "");
  if (!validation.true_surfaces.has_filename())  // a slash at the end
    validation.true_surfaces = validation.true_surfaces.parent_path();
  validation.true_positions = entry->Path("true_positions", "");
  validation.true_mesh = entry->Path("true_mesh", "");
  validation.true_forces = entry->Path("true_forces", "");
  if (validation.true_positions.empty() != validation.true_mesh.empty())
    entry->Fail("true_positions", "needs true_mesh, and the reverse");
  CheckKnownAnswers(*entry, *study);
}

// Refuses to estimate a noise that the recording cannot show (point_noise.h). Only a fit of forces
// needs it.
void RequireNoise(const Config& config, const ReconstructionStudy& study) {
  if (!study.follow.forces.AreFitted() || study.follow.noise > 0 || IsScan(study.recording)) return;
  const auto refuse = [&config](const std::string& reason) {
    const std::string message = "must be given: " + reason;
    if (const auto fit = config.OptionalChild("fit")) fit->Fail("noise", message);
    config.Fail("fit", "noise " + message);
  };
  if (study.follow.use_identity) {
    if (study.frames.size() < kFewestNoiseFrames)
      refuse(
          fmt::format("the noise of tracked points is estimated from their tracks over at least "
                      "{} frames; {} are followed",
                      kFewestNoiseFrames, study.frames.size()));
  } else if (!HasTrackedPoints(study.recording)) {
    refuse(
        "with `use_identity: false` the noise is estimated from planes through neighbouring "
        "points, for which markers are too far apart");
  }
}

// The given paths of grips, and known forces, must cover the frames; known forces need a region.
// Warns where measured forces are not used.
void CheckPathsAndForces(const Config& config, ReconstructionStudy* study) {
  Recording& recording = study->recording;
  const int first = study->frames.front(), last = study->frames.back();
  if (const std::string problem = DescribeUncoveredPath(recording, first, last); !problem.empty())
    config.Fail("recording", problem);
  if (study->follow.forces.kind != ForceSettings::Kind::kKnown) {
    if (!recording.object.forces.empty()) {
      recording.warnings.push_back(
          "the recording's measured forces are not used: forces.model is not known");
    }
    return;
  }
  const Config forces = config.Child("forces");
  if (recording.object.forces.empty())
    forces.Fail("model", "known forces, but the recording has no forces");
  for (const MeasuredForce& force : recording.object.forces)
    if (!force.region)
      forces.Fail("model",
                  fmt::format("the recording does not say where {} acts (its region)", force.name));
  if (const std::string problem = DescribeUncoveredForce(recording, first, last); !problem.empty())
    forces.Fail("model", problem);
}

}  // namespace

ReconstructionStudy ReadReconstruction(const Config& config) {
  if (config.Has("recordings") && !config.Has("recording"))
    config.Fail("recordings",
                "makes this an experiment for `lacuna fit`, which predicts; a "
                "reconstruction has one `recording`");
  return ReadReconstruction(config, LoadRecording(config, "recording"));
}

ReconstructionStudy ReadReconstruction(const Config& config, const Recording& recording) {
  ReconstructionStudy study;
  config.Integer("schema_version", 1, 1);
  study.name = config.Name("name");
  if (config.Has("output") && config.Text("output").empty())
    config.Fail("output", "is empty; expected a folder");
  study.output = config.Path("output", "../results/" + study.name);
  study.seed = static_cast<uint64_t>(config.Integer("seed", 0, 1 << 30, 1));
  study.recording = recording;
  study.frames = ReadFrames(config, study.recording);
  if (const auto filter = config.OptionalChild("filter")) study.filter = ReadFilter(*filter);
  if (const auto surface = config.OptionalChild("surface")) {
    study.surfaces_of_frames =
        surface->Choice<bool>("of_frames", {{"poisson", true}, {"none", false}}, "poisson");
    study.surface = ReadSurface(*surface);
  }
  if (const auto registration = config.OptionalChild("registration"))
    study.registration = ReadRegistration(*registration);
  const Config mesh = config.Child("mesh");
  study.mesh = ReadMeshSettings(mesh);
  study.sheet_layers = mesh.Integer("sheet_layers", 1, 100, study.sheet_layers);
  study.density = study.recording.object.density ? config.Quantity("density", kDensity, kPositive,
                                                                   *study.recording.object.density)
                                                 : config.Quantity("density", kDensity, kPositive);
  study.effects = ReadEffects(config);
  study.follow = ReadFollow(config, study.recording.data.folder);
  if (study.follow.forces.region) AddFileOf(*study.follow.forces.region, &study.recording);
  std::vector<Region*> regions = RegionsIn(&study.recording.object);
  if (study.follow.forces.region) regions.push_back(&*study.follow.forces.region);
  NumberListedNodes(study.recording, study.mesh, regions);
  ReadValidation(config, &study);
  RequireNoise(config, study);
  WarnOfIgnoredKeys(config, &study);
  config.RefuseUnknownKeys();
  if (study.frames.size() < 2 && study.recording.reference.source == ReferenceSource::kFirstFrame) {
    config.Fail("recording",
                "has one frame, which would be both the reference shape and the motion; give a "
                "reference shape or more frames");
  }
  CheckPathsAndForces(config, &study);
  const BodyScale scale = {YoungModulusOf(study.effects), study.density, study.recording.size};
  for (const std::string& warning : ImplausibleParameters(study.effects, scale))
    study.recording.warnings.push_back(warning);
  if (const std::string warning = AuxeticWarning(study.effects); !warning.empty())
    study.recording.warnings.push_back(warning);
  if (const std::string warning = GravityWarning(study.recording.object, study.effects);
      !warning.empty())
    study.recording.warnings.push_back(warning);
  study.configuration = config.Resolved();
  return study;
}

}  // namespace lacuna
