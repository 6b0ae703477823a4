#include "diagnosis/loaded_bar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <sstream>

#include "calibration/adaptive_time_step.h"
#include "effects/catalogue.h"
#include "fem/prescribed_force.h"
#include "fem/stepper.h"
#include "geometry/embedding.h"
#include "prediction/prediction_study_reader.h"
#include "support/held_bar.h"

namespace lacuna {
namespace {

constexpr double kFilmStep = 0.1;  // s

// N, along z: up in 4 s, then held, half of it from 10 s on.
double LoadAt(double time) {
  if (time < 4) return -0.02 * time;
  if (time < 9) return -0.08;
  return -0.08 + 0.04 * std::min(1.0, time - 9);
}

}  // namespace

std::shared_ptr<const Effect> LoadedBar::BedBelow() {
  return MakeEffect("elastic_support", {{"modulus", 1.5e5},
                                        {"side_z", -1},
                                        {"point_x", 0.047},
                                        {"point_z", -0.01},
                                        {"radius", 0.009}});
}

std::vector<Eigen::Matrix3Xd> LoadedBar::Film(
    const std::vector<std::shared_ptr<const Effect>>& hidden) {
  Model model;
  model.body = std::make_shared<const Body>(MakeBody(BarMesh({10, 3, 3}, 2), 1000));
  const TetMesh& mesh = model.body->mesh;
  model.effects = {
      MakeEffect("neo_hookean", {{"young_modulus", kModulus}, {"poisson_ratio", kRatio}}),
      MakeEffect("gravity", {{"acceleration_z", -9.80665}})};
  model.effects.insert(model.effects.end(), hidden.begin(), hidden.end());
  model.grips = {{NodesWhere(mesh, [](const Eigen::Vector3d& at) { return at.x() < 0.002; }), {}}};
  const Eigen::VectorXd share = BoundaryShares(
      *model.body, NodesWhere(mesh, [](const Eigen::Vector3d& at) { return at.x() > 0.078; }));
  Stepper stepper(model, {.scheme = TimeScheme::kQuasiStatic});
  MotionHistory history = RestHistory(model);
  EXPECT_TRUE(stepper.Equilibrium({}, &history).IsUsable());
  const Embedding places = Embed(mesh, BarMarkerPlaces());
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, kNoise);
  std::vector<Eigen::Matrix3Xd> markers;
  const int of_second = static_cast<int>(std::lround(1 / kFilmStep));
  for (int step = 0; step <= (kLoads - 1) * of_second; ++step) {
    if (step > 0) {
      Eigen::VectorXd force = Eigen::VectorXd::Zero(3 * share.size());
      for (Eigen::Index i = 0; i < share.size(); ++i)
        force[3 * i + 2] = share[i] * LoadAt(kFilmStep * step);
      EXPECT_TRUE(stepper.Step(kFilmStep, force, &history).IsUsable());
    }
    if (step % of_second != 0) continue;
    markers.push_back(PointsAt(places, mesh, history.position.reshaped(3, mesh.NodeCount())));
    for (double& coordinate : markers.back().reshaped()) coordinate += noise(random);
  }
  return markers;
}

PredictionStudy LoadedBar::Record(const std::vector<std::shared_ptr<const Effect>>& hidden,
                                  const std::string& more, const std::string& effects,
                                  double reading) {
  WriteBarRecording(folder_.Path(), Film(hidden));
  std::ofstream load(folder_ / "load.csv");
  load << "t,x,y,z\n";
  for (int k = 0; k < kLoads; ++k) load << fmt::format("{},0,0,{}\n", k, reading * LoadAt(k));
  load.close();
  std::ofstream(folder_ / "recording.yaml", std::ios::app) << R"(forces:
  - name: load
    file: load.csv
    time: t
    x: x
    y: y
    z: z
    unit: N
    region: {half_space: {point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}}
)";
  // A frame a second.
  std::string text = FileContent(folder_ / "markers.csv");
  std::ofstream csv(folder_ / "markers.csv");
  std::istringstream lines(text);
  std::string line;
  for (int row = -1; std::getline(lines, line); ++row)
    csv << (row < 0 ? line : fmt::format("{}{}", row, line.substr(line.find(',')))) << '\n';
  csv.close();
  return Experiment(more, effects);
}

PredictionStudy LoadedBar::Experiment(const std::string& more, const std::string& effects) const {
  return ReadPredictionStudy(
      Config::Parse(fmt::format(R"(schema_version: 1
name: loaded bar
mesh: {{max_volume: 1000 mm^3, order: 2}}
material: {{law: neo_hookean, young_modulus: 0.15 MPa, poisson_ratio: 0.4}}
effects: [{{type: gravity, acceleration: [0, 0, -9.80665 m/s^2]}}{}]
motion: {{scheme: quasi_static}}
noise: 0.02 mm
place_deviation: 0.1 mm
{}recordings: [{{recording: {}, fit_until: 11 s}}]
)",
                                effects, more, (folder_ / "recording.yaml").string()),
                    (folder_ / "study.yaml").string()));
}

Diagnosis LoadedBar::FitAndDiagnose(PredictionStudy* study) {
  const TetMesh mesh = BarMesh({7, 1, 1}, 2);
  const AdaptedFit fit = FitWithAdaptiveTimeStep(mesh, study, &progress_);
  EXPECT_TRUE(fit.calibration.usable) << fit.calibration.message;
  const CalibrationProblem problem(*study, mesh);
  DiagnosisOptions options;
  options.refits = 2;
  return Diagnose(problem, fit.calibration.parameters, options, &progress_);
}

}  // namespace lacuna
