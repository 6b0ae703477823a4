#include "trials/trial_film.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/atomic_file.h"
#include "core/error.h"
#include "effects/catalogue.h"
#include "fem/prediction.h"
#include "fem/prescribed_force.h"
#include "geometry/embedding.h"
#include "geometry/rotation.h"
#include "geometry/rounded_box.h"
#include "meshing/tetrahedralize.h"
#include "scan/random_bits.h"

namespace lacuna {
namespace {

constexpr int kFrames = 60;
constexpr double kSpacing = 0.01;    // s
constexpr double kRelease = 0.1037;  // s
constexpr double kFitUntil = 0.451;  // s
constexpr double kFace = 1e-5;       // m: the clamp and the hand hold the faces at the ends
constexpr double kTrueVolume = 8e-8, kModelVolume = 4e-7, kCoarseVolume = 4e-6;  // m³, tetrahedra
constexpr double kTrueStep = 0.0005, kRoughStep = 0.002;                         // s
constexpr int kMarkers = 8;
constexpr double kPlaceError = 1e-4;  // m, per axis
constexpr double kDensity = 1000;     // kg/m³

double Gauss(const TrialCase& trial, uint64_t stream, uint64_t i, uint64_t j) {
  return Normal(RandomBits({trial.seed, stream, i, j}));
}

Eigen::Matrix3Xd MarkerPlaces(const Eigen::Vector3d& size) {
  Eigen::Matrix3Xd places(3, kMarkers);
  for (int m = 0; m < kMarkers; ++m) {
    const double angle = 0.5 * std::numbers::pi * (m % 4);
    places.col(m) << size[0] * (0.15 + 0.85 * m / (kMarkers - 1)), 0.5 * size[1] * std::cos(angle),
        0.5 * size[2] * std::sin(angle);
  }
  return places;
}

// What the clamp does once the bar has swung freely: it turns, so that weight acts another way and
// what is fixed to the object parts from what is fixed in space; and it shakes, so that the second
// mode takes part and the bar moves with and against what stands still.
struct ClampProgram {
  Eigen::Vector3d turn, shake;  // rad, m
  double frequency;             // Hz
};
const ClampProgram kPrograms[] = {{{1.4, 0, 0}, {0, 1.2e-3, 1.6e-3}, 7},
                                  {{0, -0.7, 0}, {0, 1.6e-3, -1.2e-3}, 11}};
constexpr double kProgramBegins = 0.25, kTurnTime = 0.2;  // s

// From 0 to 1 with no acceleration at either end.
double SmoothStep(double t) {
  const double s = std::clamp(t, 0.0, 1.0);
  return s * s * s * (10 + s * (6 * s - 15));
}

// Rotation vector and shift of the clamp.
std::pair<Eigen::Vector3d, Eigen::Vector3d> ClampMotion(int recording, double time) {
  const ClampProgram& program = kPrograms[recording];
  const double since = time - kProgramBegins, risen = SmoothStep(since / kTurnTime);
  return {risen * program.turn,
          risen * std::sin(2 * std::numbers::pi * program.frequency * since) * program.shake};
}

Eigen::Isometry3d ClampPlace(int recording, double time) {
  const auto [turn, shift] = ClampMotion(recording, time);
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  place.translate(shift);
  place.rotate(RotationBy(turn));
  return place;
}

Eigen::VectorXi NodesBetween(const Eigen::Matrix3Xd& nodes, double low, double high) {
  std::vector<int> chosen;
  for (Eigen::Index i = 0; i < nodes.cols(); ++i)
    if (nodes(0, i) >= low && nodes(0, i) <= high) chosen.push_back(static_cast<int>(i));
  return Eigen::Map<Eigen::VectorXi>(chosen.data(), static_cast<Eigen::Index>(chosen.size()));
}

std::vector<Eigen::Matrix3Xd> Film(const TrialCase& trial, int recording, bool rough) {
  // A clamp that reaches further is a bar that begins later.
  Eigen::Vector3d size = trial.true_size;
  size[0] -= trial.clamp_error;
  const Eigen::Vector3d centre(trial.clamp_error + 0.5 * size[0], 0, 0);
  const MeshResult mesh = MeshTetrahedra(RoundedBox(centre, size, 0, 0.006),
                                         {.radius_edge_ratio = 1.7,
                                          .max_volume = rough ? kModelVolume : kTrueVolume,
                                          .preserve_surface = false,
                                          .order = 2});
  if (!mesh.IsUsable()) throw InputError(trial.name + ": " + mesh.message);
  Model model;
  model.body = std::make_shared<const Body>(MakeBody(mesh.mesh, kDensity));
  model.effects = {MakeEffect("neo_hookean", {{"young_modulus", trial.young_modulus},
                                              {"poisson_ratio", trial.poisson_ratio}})};
  if (!trial.Hides("stiffness_damping"))
    model.effects.push_back(
        MakeEffect("stiffness_damping", {{"beta", trial.damping},
                                         {"young_modulus", trial.young_modulus},
                                         {"poisson_ratio", trial.poisson_ratio}}));
  if (!trial.Hides("gravity"))
    model.effects.push_back(MakeEffect("gravity", {{"acceleration_z", -9.80665}}));
  for (const HiddenEffect& hidden : trial.hidden) {
    if (IsLaw(hidden))
      model.effects.front() = MakeHidden(hidden);
    else
      model.effects.push_back(MakeHidden(hidden));
  }
  const Eigen::Matrix3Xd& nodes = model.body->mesh.nodes;
  const Eigen::VectorXi clamped = NodesBetween(nodes, -1, trial.clamp_error + kFace);
  const Eigen::Matrix3Xd rest = nodes(Eigen::all, clamped);
  model.grips = {{clamped, [rest, recording](double time) -> Eigen::Matrix3Xd {
                    return ClampPlace(recording, time) * rest;
                  }}};
  const Eigen::VectorXd share = BoundaryShares(
      *model.body, NodesBetween(nodes, trial.true_size[0] - kFace, trial.true_size[0] + 1));
  PredictionOptions options;
  options.start_time = kRelease;
  options.time_step = rough ? kRoughStep : kTrueStep;
  options.held_force.resize(3 * share.size());
  for (Eigen::Index i = 0; i < share.size(); ++i)
    options.held_force.segment<3>(3 * i) = share[i] * trial.hold_forces[recording];
  std::vector<double> times;
  for (int f = 0; f < kFrames; ++f) {
    double time = kSpacing * f;
    if (trial.nuisance == "time_jitter")
      time += 0.0015 * std::clamp(Gauss(trial, 40 + recording, f, 0), -2.0, 2.0);
    times.push_back(time);
  }
  const Embedding places = Embed(model.body->mesh, MarkerPlaces(trial.true_size));
  std::vector<Eigen::Matrix3Xd> frames;
  const PredictionSummary summary =
      Predict(model, options, times, {}, [&](int, const PredictedState& state) {
        frames.push_back(
            PointsAt(places, model.body->mesh, state.position.reshaped(3, nodes.cols())));
      });
  if (!summary.IsUsable())
    throw InputError(
        fmt::format("{}: the truth cannot be simulated: {}", trial.name, summary.message));
  return frames;
}

void AddNoise(const TrialCase& trial, int recording, std::vector<Eigen::Matrix3Xd>* frames) {
  const double memory =
      trial.noise_correlation_time > 0 ? std::exp(-kSpacing / trial.noise_correlation_time) : 0;
  Eigen::Matrix3Xd noise = Eigen::Matrix3Xd::Zero(3, kMarkers);
  for (size_t f = 0; f < frames->size(); ++f) {
    for (Eigen::Index k = 0; k < noise.size(); ++k) {
      const double fresh = trial.noise * Gauss(trial, 20 + recording, f, k);
      double& value = noise.reshaped()[k];
      value = f == 0 ? fresh : memory * value + std::sqrt(1 - memory * memory) * fresh;
    }
    (*frames)[f] += noise;
  }
  if (trial.nuisance != "bad_frame") return;
  const size_t bad = 20 + RandomBits({trial.seed, 60}) % (frames->size() - 25);
  Eigen::Vector3d shift, turn;
  for (int axis = 0; axis < 3; ++axis) {
    shift[axis] = 8e-4 * Gauss(trial, 61, axis, recording);
    turn[axis] = 0.01 * Gauss(trial, 62, axis, recording);
  }
  Eigen::Matrix3Xd& frame = (*frames)[bad];
  for (Eigen::Index m = 0; m < frame.cols(); ++m)
    frame.col(m) += shift + turn.cross(Eigen::Vector3d(frame.col(m)));
}

void WriteRecording(const TrialCase& trial, int recording,
                    const std::vector<Eigen::Matrix3Xd>& frames,
                    const std::filesystem::path& folder) {
  MakeFolder(folder);
  std::string box = "OFF\n8 12 0\n";
  for (int corner = 0; corner < 8; ++corner)
    box += fmt::format("{} {} {}\n", corner & 1 ? trial.size[0] : 0.0,
                       (corner & 2 ? 0.5 : -0.5) * trial.size[1],
                       (corner & 4 ? 0.5 : -0.5) * trial.size[2]);
  for (const char* face : {"0 2 1", "1 2 3", "4 5 6", "5 7 6", "0 1 4", "1 5 4", "2 6 3", "3 6 7",
                           "0 4 2", "2 4 6", "1 3 5", "3 7 5"})
    box += fmt::format("3 {}\n", face);
  WriteFileAtomically(folder / "box.off", box);

  std::string csv = "t";
  for (int m = 0; m < kMarkers; ++m) csv += fmt::format(",m{0}_x,m{0}_y,m{0}_z", m);
  std::string path = "t,x,y,z,rx,ry,rz\n";
  for (size_t f = 0; f < frames.size(); ++f) {
    csv += fmt::format("\n{}", kSpacing * static_cast<double>(f));
    for (const double coordinate : frames[f].reshaped()) csv += fmt::format(",{:.9f}", coordinate);
  }
  for (int k = 0; k <= 10 * kFrames; ++k) {
    const double time = 0.1 * kSpacing * k;
    const auto [turn, shift] = ClampMotion(recording, time);
    path += fmt::format("{}", time);
    for (const double coordinate : shift) path += fmt::format(",{:.9f}", coordinate);
    for (const double angle : turn) path += fmt::format(",{:.9f}", angle);
    path += "\n";
  }
  WriteFileAtomically(folder / "markers.csv", csv + "\n");
  WriteFileAtomically(folder / "clamp.csv", path);
  std::string yaml = fmt::format(
      "schema_version: 1\nname: recording {}\nlength_unit: m\ndensity: {} kg/m^3\nframes:\n"
      "  kind: markers\n  file: markers.csv\n  columns: {{time: t}}\n  marker_places:\n",
      recording + 1, kDensity);
  const Eigen::Matrix3Xd places = MarkerPlaces(trial.size);
  for (int m = 0; m < kMarkers; ++m) {
    Eigen::Vector3d place = places.col(m);
    for (int axis = 0; axis < 3; ++axis) place[axis] += kPlaceError * Gauss(trial, 30, m, axis);
    yaml += fmt::format("    - {{name: m{}, position: [{:.6f} m, {:.6f} m, {:.6f} m]}}\n", m,
                        place.x(), place.y(), place.z());
  }
  yaml += fmt::format(
      "gripped:\n  - {{name: clamp, half_space: {{point: [{} m, 0 m, 0 m], normal: [-1, 0, 0]}}, "
      "path: {{file: clamp.csv, time: t, x: x, y: y, z: z, turn: {{x: rx, y: ry, z: rz, about: [0, "
      "0, 0]}}}}}}\n"
      "reference: {{from: mesh, file: box.off}}\n",
      kFace);
  WriteFileAtomically(folder / "recording.yaml", yaml);
}

}  // namespace

void FilmCase(const TrialCase& trial, const std::filesystem::path& folder, bool rough) {
  MakeFolder(folder);
  std::string known, fitted = "{name: young_modulus}, {name: poisson_ratio}";
  if (!trial.Hides("stiffness_damping")) {
    known += "  - {type: stiffness_damping, beta: 0.5 ms}\n";
    fitted += ", {name: stiffness_damping.beta}";
  }
  if (!trial.Hides("gravity"))
    known += "  - {type: gravity, acceleration: [0, 0, -9.80665 m/s^2]}\n";
  std::string yaml = fmt::format(
      "schema_version: 1\nname: {}\nmesh: {{max_volume: {} m^3, order: 2, preserve_surface: "
      "false}}\n"
      "material: {{law: neo_hookean, young_modulus: 0.12 MPa, poisson_ratio: 0.42}}\n"
      "effects:{}\nfit: {{parameters: [{}]}}\n"
      "{}place_deviation: {} m\nrecordings:\n",
      trial.name, trial.nuisance == "coarse_mesh" ? kCoarseVolume : kModelVolume,
      known.empty() ? " []" : "\n" + known, fitted,
      rough ? fmt::format("motion: {{time_step: {} s}}\n", kRoughStep) : "", 2 * kPlaceError);
  for (int r = 0; r < trial.recordings; ++r) {
    std::vector<Eigen::Matrix3Xd> frames = Film(trial, r, rough);
    AddNoise(trial, r, &frames);
    const std::string name = fmt::format("recording_{}", r + 1);
    WriteRecording(trial, r, frames, folder / name);
    yaml += fmt::format(
        "  - recording: {}\n    fit_until: {} s\n    hold:\n      release: {} s\n      region: "
        "{{half_space: {{point: [{} m, 0 m, 0 m], normal: [1, 0, 0]}}}}\n",
        name, kFitUntil, kRelease, trial.size[0] - kFace);
  }
  WriteFileAtomically(folder / "experiment.yaml", yaml);
}

}  // namespace lacuna
