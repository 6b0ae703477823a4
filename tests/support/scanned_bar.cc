#include "support/scanned_bar.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "effects/catalogue.h"
#include "fem/prediction.h"
#include "fem/prescribed_force.h"

namespace lacuna {
namespace {

Model BarModel(const HeldBarTruth& truth, bool gravity, double clamp) {
  Model model;
  model.body = std::make_shared<const Body>(MakeBody(BarMesh({8, 2, 2}, 2), 1000));
  model.effects = {
      MakeEffect("neo_hookean", {{"young_modulus", truth.young_modulus}, {"poisson_ratio", 0.4}}),
      MakeEffect("mass_damping", {{"alpha", truth.alpha}})};
  if (gravity) model.effects.push_back(MakeEffect("gravity", {{"acceleration_z", -9.80665}}));
  if (truth.body_force)
    model.effects.push_back(std::make_shared<PrescribedForce>(
        model.body->node_mass / model.body->node_mass.sum(), truth.body_force));
  model.grips = {
      {NodesWhere(model.body->mesh, [clamp](const Eigen::Vector3d& at) { return at.x() < clamp; }),
       {}}};
  return model;
}

double ScanTime(int frame) { return 0.02 * frame; }

std::vector<TriMesh> Surfaces(const Model& model, const PredictionOptions& options) {
  std::vector<double> times;
  for (int frame = 0; frame < kScans; ++frame) times.push_back(ScanTime(frame));
  std::vector<TriMesh> surfaces;
  const PredictionSummary summary =
      Predict(model, options, times, {}, [&](int, const PredictedState& state) {
        surfaces.push_back(BoundaryAt(model.body->boundary,
                                      state.position.reshaped(3, model.body->mesh.NodeCount())));
      });
  EXPECT_TRUE(summary.IsUsable()) << summary.message;
  return surfaces;
}

}  // namespace

std::vector<TriMesh> HeldBarSurfaces(const HeldBarTruth& truth) {
  const Model model = BarModel(truth, /*gravity=*/true, 0.002);
  const Eigen::VectorXd share = BoundaryShares(
      *model.body,
      NodesWhere(model.body->mesh, [](const Eigen::Vector3d& at) { return at.x() > 0.078; }));
  PredictionOptions options;
  options.start_time = kRelease;
  options.time_step = 0.001;
  options.held_force.resize(3 * share.size());
  for (Eigen::Index i = 0; i < share.size(); ++i)
    options.held_force.segment<3>(3 * i) = share[i] * truth.hold_force;
  return Surfaces(model, options);
}

Eigen::Matrix3Xd CarriedPath() {
  Eigen::Matrix3Xd path(3, kScans);
  for (int frame = 0; frame < kScans; ++frame) {
    const double phase = std::clamp((ScanTime(frame) - 0.02) / 0.1, 0.0, 1.0);
    const double share = phase * phase * (3 - 2 * phase);
    path.col(frame) << 0, 0.015 * share, -0.006 * share;
  }
  return path;
}

std::vector<TriMesh> CarriedBarSurfaces(const HeldBarTruth& truth, const Eigen::Matrix3Xd& path) {
  Model model = BarModel(truth, /*gravity=*/false, 0.011);
  RecordedGrip grip;
  grip.displacements = path;
  grip.times.resize(kScans);
  for (int frame = 0; frame < kScans; ++frame) grip.times[frame] = ScanTime(frame);
  const Eigen::Matrix3Xd rest = model.body->mesh.nodes(Eigen::all, model.grips[0].nodes);
  model.grips[0].motion = [grip, rest](double time) -> Eigen::Matrix3Xd {
    return MotionAt(grip, time) * rest;
  };
  PredictionOptions options;
  options.time_step = 0.001;
  return Surfaces(model, options);
}

void WriteBarScans(const std::filesystem::path& folder, const std::vector<TriMesh>& surfaces,
                   const std::string& rest, FrameWriter write_frames) {
  std::vector<double> times;
  for (int frame = 0; frame < kScans; ++frame) times.push_back(ScanTime(frame));
  CameraRing ring;
  ring.center = {0.04, 0, 0};
  ring.radius = 0.25;
  ring.up = Eigen::Vector3d::UnitX();  // so that both ends are seen
  ring.elevation = 0.6;
  ring.width = 120;
  ring.height = 90;
  ring.field_of_view = 0.6;
  ScannerOptions options;
  options.noise = kScanNoise;
  options.seed = 3;
  RecordedObject object;
  object.density = 1000;
  WriteScan(folder, "bar", object, {surfaces, times, PlaceCameras(ring), options}, write_frames);
  std::ofstream(folder / "recording.yaml", std::ios::app) << rest;
  WriteBox(folder / "box.off");
}

}  // namespace lacuna
