#include "support/pulled_bar.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "effects/catalogue.h"
#include "fem/prediction.h"
#include "geometry/embedding.h"
#include "geometry/rotation.h"
#include "prediction/prediction_study_reader.h"
#include "support/replace_in_file.h"

namespace lacuna {

TetMesh PulledBarMesh() { return BarMesh({8, 2, 2}, 2); }

void WritePulledBar(const std::filesystem::path& folder, const PulledBarTruth& truth,
                    const std::string& measured_force, const std::string& measured_torque) {
  Model model;
  model.body = std::make_shared<const Body>(MakeBody(PulledBarMesh(), 1000));
  const TetMesh& mesh = model.body->mesh;
  model.effects = {
      MakeEffect("neo_hookean", {{"young_modulus", truth.young_modulus}, {"poisson_ratio", 0.4}})};
  model.effects.insert(model.effects.end(), truth.hidden.begin(), truth.hidden.end());
  const Eigen::VectorXi jaw =
      NodesWhere(mesh, [](const Eigen::Vector3d& at) { return at.x() > 0.078; });
  const Eigen::Matrix3Xd rest = mesh.nodes(Eigen::all, jaw);
  model.grips = {{NodesWhere(mesh, [](const Eigen::Vector3d& at) { return at.x() < 0.002; }), {}},
                 {jaw, [rest, twist = truth.twist](double time) -> Eigen::Matrix3Xd {
                    const Eigen::Matrix3d turn = RotationBy({twist * time, 0, 0});
                    return (turn * rest).colwise() + Eigen::Vector3d(kStretch * time, 0, 0);
                  }}};
  PredictionOptions options;
  options.time_step = 1;
  options.step.scheme = TimeScheme::kQuasiStatic;
  options.reactions = {{1, {}}, {1, Eigen::Vector3d::Zero()}};
  std::vector<double> times;
  for (int frame = 0; frame < kPulledFrames; ++frame) times.push_back(frame);
  const Embedding places = Embed(mesh, BarMarkerPlaces());
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Matrix3Xd> markers;
  std::normal_distribution<double> torque_noise(0, truth.torque_noise);
  std::mt19937 other_random(6);
  std::string forces = "t,fx,mx\n", path = "t,x,y,z,rx,ry,rz\n";
  const PredictionSummary summary =
      Predict(model, options, times, {}, [&](int, const PredictedState& state) {
        markers.push_back(PointsAt(places, mesh, state.position.reshaped(3, mesh.NodeCount())));
        for (double& coordinate : markers.back().reshaped())
          coordinate += truth.noise * normal(random);
        forces += fmt::format(
            "{},{},{}\n", state.time + truth.delay,
            truth.sign * (state.reaction[0] + truth.tare + truth.force_noise * normal(random)),
            state.reaction[3] + torque_noise(other_random));
        path += fmt::format("{},{},0,0,{},0,0\n", state.time, kStretch * state.time,
                            truth.twist * state.time);
      });
  EXPECT_TRUE(summary.IsUsable()) << summary.message;
  WriteBarRecording(folder, markers);
  // A frame a second in place of a hundred.
  std::string csv = "t";
  for (int m = 0; m < kMarkers; ++m) csv += fmt::format(",m{0}_x,m{0}_y,m{0}_z", m);
  for (size_t frame = 0; frame < markers.size(); ++frame) {
    csv += fmt::format("\n{}", frame);
    for (const double coordinate : markers[frame].reshaped()) csv += fmt::format(",{}", coordinate);
  }
  std::ofstream(folder / "markers.csv") << csv << "\n";
  std::ofstream(folder / "force.csv") << forces;
  std::ofstream(folder / "jaw.csv") << path;
  std::ofstream(folder / "recording.yaml", std::ios::app)
      << "gripped:\n  - {name: jaw, half_space: {point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}, "
         "path: {file: jaw.csv, time: t, x: x, y: y, z: z"
      << (truth.twist == 0 ? "}" : ", turn: {x: rx, y: ry, z: rz, about: [0 m, 0 m, 0 m]}}")
      << (measured_force.empty() ? "" : ", measured_force: " + measured_force)
      << (measured_torque.empty() ? "" : ", measured_torque: " + measured_torque) << "}\n";
}

std::string PulledBarExperiment(const std::filesystem::path& folder,
                                const std::map<std::string, std::string>& replaced) {
  const std::string text = fmt::format(R"(schema_version: 1
name: pulled
output: run
mesh: {{max_volume: 1000 mm^3, order: 2}}
material: {{law: neo_hookean, young_modulus: 0.15 MPa, poisson_ratio: 0.4}}
motion: {{scheme: quasi_static, time_step: 1 s}}
noise: 0.05 mm
place_deviation: 0.2 mm
fit: {{parameters: [{{name: young_modulus}}]}}
recordings:
  - recording: {}
    fit_until: {} s
)",
                                       (folder / "recording.yaml").string(), kPulledUntil);
  return WithReplacements(text, replaced);
}

PredictionStudy ReadPulledBarStudy(const std::filesystem::path& folder,
                                   const std::map<std::string, std::string>& replaced) {
  return ReadPredictionStudy(
      Config::Parse(PulledBarExperiment(folder, replaced), (folder / "study.yaml").string()));
}

}  // namespace lacuna
