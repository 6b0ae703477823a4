// Writes a static case of the size that volume correlation gives: a bar with a stiff lump, loaded
// in five steps, whose displacement is known at 400 points inside, and an experiment that explains
// it with linear tetrahedra and without the lump:
//   static_case FOLDER
//   lacuna fit FOLDER/experiment.yaml
//   lacuna diagnose FOLDER/run
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "core/error.h"
#include "core/logging.h"
#include "effects/catalogue.h"
#include "fem/prescribed_force.h"
#include "fem/stepper.h"
#include "geometry/embedding.h"
#include "support/box_mesh.h"
#include "support/marker_recording.h"

namespace lacuna {
namespace {

constexpr int kPoints = 400, kSteps = 5;
constexpr double kNoise = 2e-5;         // m
constexpr double kLoadPerStep = -0.04;  // N, along z

const Eigen::Vector3d kLow(0, -0.01, -0.01), kHigh(0.08, 0.01, 0.01);  // m, corners of the bar

constexpr char kExperiment[] = R"(schema_version: 1
name: static_case
output: run
mesh: {max_volume: 2.6 mm^3, order: 1, preserve_surface: false}   # about 29 000 tetrahedra
material: {law: neo_hookean, young_modulus: 0.15 MPa, poisson_ratio: 0.4}
effects: [{type: gravity, acceleration: [0, 0, -9.80665 m/s^2]}]
motion: {scheme: quasi_static}
noise: 0.02 mm
place_deviation: 0.05 mm
recordings: [{recording: recording.yaml, fit_until: 3.5 s}]
)";

Model TrueModel() {
  Model model;
  model.body = std::make_shared<const Body>(MakeBody(BoxMesh(kLow, kHigh, {16, 5, 5}, 2), 1000));
  model.effects = {MakeEffect("neo_hookean", {{"young_modulus", 9e4}, {"poisson_ratio", 0.42}}),
                   MakeEffect("gravity", {{"acceleration_z", -9.80665}}),
                   MakeEffect("inclusion", {{"centre_x", 0.05},
                                            {"centre_y", 0.003},
                                            {"centre_z", 0},
                                            {"radius", 0.008},
                                            {"young_modulus_difference", 1.5e5},
                                            {"poisson_ratio", 0.42}})};
  model.grips = {
      {NodesWhere(model.body->mesh, [](const Eigen::Vector3d& at) { return at.x() < 0.002; }), {}}};
  return model;
}

Eigen::Matrix3Xd Places(std::mt19937* random) {
  std::uniform_real_distribution<double> share(0, 1);
  Eigen::Matrix3Xd places(3, kPoints);
  for (auto place : places.colwise())
    place << 0.004 + 0.075 * share(*random), -0.0095 + 0.019 * share(*random),
        -0.0095 + 0.019 * share(*random);
  return places;
}

void WriteRecording(const std::filesystem::path& folder, const Eigen::Matrix3Xd& places) {
  std::ofstream yaml(folder / "recording.yaml");
  yaml << R"(schema_version: 1
name: bar
length_unit: m
density: 1000 kg/m^3
fixed: [{name: clamp, half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, 0]}}]
reference: {from: mesh, file: box.off}
forces:
  - {name: load, file: load.csv, time: t, x: x, y: y, z: z, unit: N,
     region: {half_space: {point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}}}
)" << MarkerFrames(places);
}

void Run(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const Model model = TrueModel();
  const TetMesh& mesh = model.body->mesh;
  const Eigen::VectorXd share = BoundaryShares(
      *model.body, NodesWhere(mesh, [](const Eigen::Vector3d& at) { return at.x() > 0.078; }));
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, kNoise);
  const Eigen::Matrix3Xd places = Places(&random);
  const Embedding embedded = Embed(mesh, places);
  std::ofstream markers(folder / "markers.csv"), loads(folder / "load.csv");
  markers << "t";
  for (int m = 0; m < kPoints; ++m) markers << fmt::format(",m{0}_x,m{0}_y,m{0}_z", m);
  loads << "t,x,y,z";
  Stepper stepper(model, {.scheme = TimeScheme::kQuasiStatic});
  MotionHistory history = RestHistory(model);
  for (int step = 0; step < kSteps; ++step) {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(3 * share.size());
    for (Eigen::Index i = 0; i < share.size(); ++i)
      force[3 * i + 2] = step * kLoadPerStep * share[i];
    const StepSummary summary =
        step == 0 ? stepper.Equilibrium(force, &history) : stepper.Step(1, force, &history);
    if (!summary.IsUsable()) throw InputError(summary.message);
    const Eigen::Matrix3Xd moved =
        PointsAt(embedded, mesh, history.position.reshaped(3, mesh.NodeCount()));
    markers << '\n' << step;
    for (const double coordinate : moved.reshaped())
      markers << fmt::format(",{:.9g}", coordinate + noise(random));
    loads << fmt::format("\n{},0,0,{}", step, step * kLoadPerStep);
  }
  markers << '\n';
  loads << '\n';
  WriteBoxSurface(folder / "box.off", kLow, kHigh);
  WriteRecording(folder, places);
  std::ofstream(folder / "experiment.yaml") << kExperiment;
}

}  // namespace
}  // namespace lacuna

int main(int argc, char** argv) {
  lacuna::InitialiseLogging(argv[0]);
  if (argc != 2) {
    fmt::print(stderr, "static_case FOLDER\n");
    return 2;
  }
  try {
    lacuna::Run(argv[1]);
  } catch (const lacuna::InputError& problem) {
    fmt::print(stderr, "static_case: {}\n", problem.what());
    return 1;
  }
  return 0;
}
