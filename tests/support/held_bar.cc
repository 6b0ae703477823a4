#include "support/held_bar.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "effects/catalogue.h"
#include "fem/prediction.h"
#include "fem/prescribed_force.h"
#include "geometry/embedding.h"
#include "prediction/prediction_study_reader.h"
#include "support/marker_recording.h"
#include "support/replace_in_file.h"

namespace lacuna {
Eigen::Matrix3Xd BarMarkerPlaces() {
  Eigen::Matrix3Xd places(3, kMarkers);
  for (int m = 0; m < kMarkers; ++m)
    places.col(m) << 0.01 + 0.07 * m / (kMarkers - 1), m % 2 == 0 ? 0.01 : -0.01, 0.01;
  return places;
}

std::vector<Eigen::Matrix3Xd> FilmHeldBar(const HeldBarTruth& truth) {
  Model model;
  model.body = std::make_shared<const Body>(MakeBody(BarMesh({8, 2, 2}, 2), 1000));
  const TetMesh& mesh = model.body->mesh;
  model.effects = {
      MakeEffect(truth.law, {{"young_modulus", truth.young_modulus}, {"poisson_ratio", 0.4}}),
      MakeEffect("gravity", {{"acceleration_z", -9.80665}}),
      MakeEffect("mass_damping", {{"alpha", truth.alpha}})};
  model.effects.insert(model.effects.end(), truth.hidden.begin(), truth.hidden.end());
  if (truth.body_force) {
    model.effects.push_back(std::make_shared<PrescribedForce>(
        model.body->node_mass / model.body->node_mass.sum(), truth.body_force));
  }
  model.grips = {{NodesWhere(mesh, [](const Eigen::Vector3d& at) { return at.x() < 0.002; }), {}}};
  const Eigen::VectorXd share = BoundaryShares(
      *model.body, NodesWhere(mesh, [](const Eigen::Vector3d& at) { return at.x() > 0.078; }));
  PredictionOptions options;
  options.start_time = kRelease;
  options.time_step = 0.0007;
  options.held_force.resize(3 * share.size());
  for (Eigen::Index i = 0; i < share.size(); ++i)
    options.held_force.segment<3>(3 * i) = share[i] * truth.hold_force;
  std::vector<double> times;
  for (int frame = 0; frame < kFrames; ++frame)
    times.push_back(0.01 * frame - truth.clock + truth.jitter * std::cos(2.4 * frame));
  const Embedding places = Embed(mesh, BarMarkerPlaces());
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0, truth.noise);
  std::vector<Eigen::Matrix3Xd> markers;
  const PredictionSummary summary =
      Predict(model, options, times, {}, [&](int, const PredictedState& state) {
        markers.push_back(PointsAt(places, mesh, state.position.reshaped(3, mesh.NodeCount())));
        for (double& coordinate : markers.back().reshaped()) coordinate += noise(random);
      });
  EXPECT_TRUE(summary.IsUsable()) << summary.message;
  return markers;
}

void WriteBox(const std::filesystem::path& file) {
  WriteBoxSurface(file, {0, -0.01, -0.01}, {0.08, 0.01, 0.01});
}

void WriteBarRecording(const std::filesystem::path& folder,
                       const std::vector<Eigen::Matrix3Xd>& markers) {
  std::filesystem::create_directories(folder);
  WriteBox(folder / "box.off");

  std::ofstream csv(folder / "markers.csv");
  csv << "t";
  for (int m = 0; m < kMarkers; ++m) csv << fmt::format(",m{0}_x,m{0}_y,m{0}_z", m);
  for (size_t frame = 0; frame < markers.size(); ++frame) {
    csv << fmt::format("\n{}", 0.01 * static_cast<double>(frame));
    for (const double coordinate : markers[frame].reshaped()) csv << fmt::format(",{}", coordinate);
  }
  csv << "\n";

  std::ofstream(folder / "load.csv") << "t,x,y,z\n0.05,0,0,0\n0.2,0,0,0\n";
  std::ofstream yaml(folder / "recording.yaml");
  yaml << R"(schema_version: 1
name: bar
length_unit: m
density: 1000 kg/m^3
)" << MarkerFrames(BarMarkerPlaces())
       << R"(fixed: [{name: clamp, half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, 0]}}]
reference: {from: mesh, file: box.off}
)";
}

std::string BarExperiment(const std::filesystem::path& folder,
                          const std::map<std::string, std::string>& replaced) {
  const std::string text = fmt::format(R"(schema_version: 1
name: bar
mesh: {{max_volume: 1000 mm^3, order: 2}}
material: {{law: neo_hookean, young_modulus: 0.15 MPa, poisson_ratio: 0.4}}
effects:
  - {{type: gravity, acceleration: [0, 0, -9.80665 m/s^2]}}
  - {{type: mass_damping, alpha: 1 1/s}}
motion: {{time_step: 1.5 ms}}
noise: 0.05 mm
place_deviation: 0.2 mm
fit: {{parameters: [{{name: young_modulus}}, {{name: mass_damping.alpha}}]}}
recordings:
  - recording: {}
    fit_until: {} s
    clock_deviation: 10 ms
    hold:
      region: {{half_space: {{point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}}}}
      release: {} s
)",
                                       (folder / "recording.yaml").string(), kFitUntil, kRelease);
  return WithReplacements(text, replaced);
}

PredictionStudy ReadBarStudy(const std::filesystem::path& folder,
                             const std::map<std::string, std::string>& replaced) {
  return ReadPredictionStudy(
      Config::Parse(BarExperiment(folder, replaced), (folder / "study.yaml").string()));
}

}  // namespace lacuna
