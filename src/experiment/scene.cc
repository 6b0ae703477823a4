#include "experiment/scene.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <Eigen/Geometry>
#include <utility>

#include "core/interrupt.h"
#include "effects/gravity.h"
#include "experiment/held_parts.h"
#include "fem/grip_reaction.h"
#include "fem/prescribed_force.h"
#include "geometry/rounded_box.h"
#include "scan/normal_noise.h"
#include "scan/scan_writer.h"

namespace lacuna {
namespace {

Eigen::Vector3d ReadAxis(const Config& config, const Eigen::Vector3d& default_axis) {
  const Eigen::Vector3d axis = config.Vector("axis", kDimensionless, default_axis);
  if (axis.norm() == 0) config.Fail("axis", "expected a direction other than 0");
  return axis.normalized();
}

BarShape ReadBar(const Config& config) {
  BarShape bar;
  bar.centre = config.Vector("centre", kLength, bar.centre);
  bar.size = config.Vector("size", kLength);
  if (bar.size.minCoeff() <= 0) config.Fail("size", "expected three lengths > 0");
  bar.edge_radius = config.Quantity("edge_radius", kLength,
                                    {0, 0.5 * bar.size.minCoeff(), false, false}, bar.edge_radius);
  bar.edge_length = config.Quantity("edge_length", kLength, {0, bar.size.maxCoeff(), true, false},
                                    bar.edge_length);
  bar.axis = ReadAxis(config, bar.axis);
  bar.angle = config.Quantity("angle", kAngle, kAnyValue, bar.angle);
  // Left out for a bar at rest, so that results kept under the hash of an older scene stay valid.
  if (config.Has("velocity")) bar.velocity = config.Vector("velocity", kVelocity);
  return bar;
}

TriMesh BarSurface(const BarShape& bar) {
  TriMesh surface = RoundedBox(bar.centre, bar.size, bar.edge_radius, bar.edge_length);
  if (bar.angle == 0) return surface;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(bar.angle, bar.axis).toRotationMatrix();
  surface.vertices = (turn * (surface.vertices.colwise() - bar.centre)).colwise() + bar.centre;
  return surface;
}

// The nodes of a bar have no numbers that could be listed.
Region ReadShape(const Config& config, const std::string& name) {
  Region region = ReadRegion(config.Child("region"), {}, name);
  if (std::holds_alternative<NodeRegion>(region.shape))
    config.Fail("region", "expected box, sphere or half_space");
  return region;
}

SceneGrip ReadGrip(const Config& config, int index) {
  SceneGrip grip;
  grip.region = ReadShape(config, fmt::format("grip {}", index));
  grip.translation = config.Vector("translation", kLength, grip.translation);
  grip.axis = ReadAxis(config, grip.axis);
  grip.centre = config.Vector("centre", kLength, grip.centre);
  grip.angle = config.Quantity("angle", kAngle, kAnyValue, grip.angle);
  grip.profile = ReadProfile(config);
  grip.axes = ReadDirections(config);
  if (!grip.axes.IsAll() && grip.angle != 0)
    config.Fail("directions", "is implemented only for grips that do not rotate");
  if (const auto cell = config.OptionalChild("measured_force")) {
    grip.force_deviation = cell->Quantity("deviation", kForce, kPositive);
    if (!grip.axes.IsAll())
      config.Fail("measured_force", "is implemented only for grips that hold along all axes");
  }
  if (const auto cell = config.OptionalChild("measured_torque")) {
    grip.torque_deviation = cell->Quantity("deviation", kTorque, kPositive);
    if (!grip.axes.IsAll())
      config.Fail("measured_torque", "is implemented only for grips that hold along all axes");
  }
  return grip;
}

Scene::Scanner ReadScanner(const Config& config, const BarShape& bar, uint64_t seed) {
  Scene::Scanner scanner;
  CameraRing& ring = scanner.ring;
  ring.count = config.Integer("cameras", 2, 6, ring.count);
  ring.center = config.Vector("look_at", kLength, bar.centre);
  ring.up = config.Vector("up", kDimensionless, ring.up);
  ring.radius = config.Quantity("distance", kLength, kPositive, ring.radius);
  ring.elevation = config.Quantity("elevation", kAngle, {0, 1.5, false, false}, ring.elevation);
  ring.width = config.Integer("width", 16, 4096, ring.width);
  ring.height = config.Integer("height", 16, 4096, ring.height);
  ring.field_of_view =
      config.Quantity("field_of_view", kAngle, {0, 3, true, false}, ring.field_of_view);
  ScannerOptions& options = scanner.options;
  options.noise = config.Quantity("noise", kLength, kNotNegative, options.noise);
  options.noise_growth = config.Number("noise_growth", {0, 4, false, false}, options.noise_growth);
  options.reference_range =
      config.Quantity("reference_range", kLength, kPositive, options.reference_range);
  options.quantum = config.Quantity("quantum", kLength, kNotNegative, options.quantum);
  options.flying_fraction =
      config.Number("flying_fraction", {0, 1, false, false}, options.flying_fraction);
  options.dropout = config.Number("dropout", {0, 1, false, true}, options.dropout);
  options.seed = seed;
  return scanner;
}

// The positions of the nodes of a grip as a function of time.
std::function<Eigen::Matrix3Xd(double)> Motion(const SceneGrip& grip,
                                               const Eigen::Matrix3Xd& rest) {
  return [grip, rest](double time) {
    const double share = grip.profile.At(time);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(share * grip.angle, grip.axis).toRotationMatrix();
    Eigen::Matrix3Xd moved = turn * (rest.colwise() - grip.centre);
    moved.colwise() += grip.centre + share * grip.translation;
    return moved;
  };
}

bool IsHeld(const SceneGrip& grip) { return grip.translation.norm() == 0 && grip.angle == 0; }

}  // namespace

Scene ReadScene(const Config& config) {
  Scene scene;
  config.Integer("schema_version", 1, 1);
  scene.name = config.Name("name");
  const int seed = config.Integer("seed", 0, 1 << 30, 1);
  scene.bar = ReadBar(config.Child("bar"));
  scene.mesh = ReadMeshSettings(config.Child("mesh"));
  scene.density = config.Quantity("density", kDensity, kPositive);
  scene.effects = ReadEffects(config);
  int index = 0;
  for (const Config& item : config.Items("grips")) scene.grips.push_back(ReadGrip(item, index++));
  for (const Config& item : config.Items("loads")) {
    scene.loads.push_back({ReadShape(item, "load"), item.Vector("force", kForce), ReadProfile(item),
                           item.Flag("measured", false)});
  }
  const Config motion = config.Child("motion");
  scene.step.scheme = ReadTimeScheme(motion, "bdf2");
  scene.frame_rate = motion.Quantity("frame_rate", kRate, kPositive);
  scene.frames = motion.Integer("frames", 1, 100000);
  scene.steps_per_frame = motion.Integer("steps_per_frame", 1, 10000, scene.steps_per_frame);
  if (const auto scanner = config.OptionalChild("scanner"))
    scene.scanner = ReadScanner(*scanner, scene.bar, static_cast<uint64_t>(seed));
  config.RefuseUnknownKeys();
  return scene;
}

SceneMotion SimulateScene(const Scene& scene, Progress* progress) {
  SceneMotion motion;
  const TriMesh surface = BarSurface(scene.bar);
  TetOptions tet_options = scene.mesh.tets;
  tet_options.order = scene.mesh.order;
  const MeshResult meshed = MeshTetrahedra(surface, tet_options);
  if (!meshed.IsUsable()) {
    motion.status = SceneMotion::Status::kMeshFailed;
    motion.message = meshed.message;
    return motion;
  }
  auto body = std::make_shared<Body>(MakeBody(meshed.mesh, scene.density));
  motion.body = body;

  Model model{body, scene.effects, {}};
  std::vector<HeldPart> parts;
  for (const SceneGrip& grip : scene.grips)
    parts.push_back({grip.region, grip.axes, !IsHeld(grip)});
  auto nodes = NodesOfParts(parts, body->mesh);
  for (size_t k = 0; k < scene.grips.size(); ++k) {
    const SceneGrip& grip = scene.grips[k];
    Grip held{std::move(nodes[k]), {}, grip.axes};
    if (!IsHeld(grip)) held.motion = Motion(grip, body->mesh.nodes(Eigen::all, held.nodes));
    model.grips.push_back(std::move(held));
  }
  for (const SceneLoad& load : scene.loads) {
    model.effects.push_back(std::make_shared<PrescribedForce>(
        BoundaryShares(*body, NodesIn(load.region, body->mesh)),
        [&load](double time) -> Eigen::Vector3d { return load.profile.At(time) * load.force; }));
  }

  std::vector<Reaction> forces, torques;
  for (size_t k = 0; k < model.grips.size(); ++k) {
    forces.push_back({k, std::nullopt});
    torques.push_back(
        {k, body->mesh.nodes(Eigen::all, model.grips[k].nodes).rowwise().mean().eval()});
  }
  motion.reactions.resize(3 * static_cast<Eigen::Index>(forces.size()), scene.frames);
  motion.torques.resizeLike(motion.reactions);

  MotionHistory history = RestHistory(model), before = history;
  history.velocity = scene.bar.velocity.replicate(body->NodeCount(), 1);
  Stepper stepper(model, scene.step);
  const double time_step = 1 / (scene.frame_rate * scene.steps_per_frame);
  progress->Begin("simulate", scene.frames);
  for (int frame = 0; frame < scene.frames; ++frame) {
    for (int k = 0; frame > 0 && k < scene.steps_per_frame; ++k) {
      ThrowIfInterrupted();
      if (k + 1 == scene.steps_per_frame) before = history;
      const StepSummary step = stepper.Step(time_step, {}, &history);
      if (!step.IsUsable()) {
        motion.status = SceneMotion::Status::kStepFailed;
        motion.message = fmt::format("frame {}: {}", frame, step.message);
        return motion;
      }
    }
    const StepEquation equation = frame == 0
                                      ? StepEquation(model, before, TimeScheme::kQuasiStatic, 0)
                                      : StepEquation(model, before, scene.step.scheme, time_step);
    const Eigen::VectorXd nodal = NodalReactions(equation, history.position, {});
    motion.reactions.col(frame) = SumReactions(model, forces, history.position, nodal);
    motion.torques.col(frame) = SumReactions(model, torques, history.position, nodal);
    Eigen::Vector3d load = Eigen::Vector3d::Zero();
    for (const SceneLoad& each : scene.loads) load += each.profile.At(history.time) * each.force;
    motion.times.push_back(frame / scene.frame_rate);
    motion.positions.push_back(history.position.reshaped(3, Eigen::AutoSize));
    motion.velocities.push_back(history.velocity.reshaped(3, Eigen::AutoSize));
    motion.stress.push_back(RecoverNodalStress(model, history.position, history.velocity,
                                               history.time, history.effect_state));
    motion.load.push_back(load);
    progress->Report(frame + 1);
  }
  progress->End();
  motion.status = SceneMotion::Status::kFinished;
  return motion;
}

SceneMotion SimulateWholeScene(const Scene& scene, Progress* progress) {
  SceneMotion motion = SimulateScene(scene, progress);
  if (!motion.IsUsable()) throw InputError(fmt::format("scene {}: {}", scene.name, motion.message));
  return motion;
}

namespace {

// The driven grip as a recording names it, with its path at the ends of the steps.
RecordedGrip DrivenGrip(const Scene& scene, const SceneGrip& grip) {
  RecordedGrip driven;
  driven.region = grip.region;
  driven.motion = GripMotion::kGiven;
  driven.axes = grip.axes;
  const Eigen::Index steps = (scene.frames - 1) * scene.steps_per_frame;
  driven.times.setLinSpaced(steps + 1, 0, (scene.frames - 1) / scene.frame_rate);
  driven.displacements.resize(3, steps + 1);
  for (Eigen::Index k = 0; k <= steps; ++k)
    driven.displacements.col(k) = grip.profile.At(driven.times[k]) * grip.translation;
  if (grip.angle == 0) return driven;
  driven.pivot = grip.centre;
  driven.rotations.resize(3, steps + 1);
  for (Eigen::Index k = 0; k <= steps; ++k)
    driven.rotations.col(k) = grip.profile.At(driven.times[k]) * grip.angle * grip.axis;
  return driven;
}

// The random streams of the noise of load cells: of their forces and of their torques.
constexpr uint64_t kForceNoise = 80, kTorqueNoise = 81;

// What the load cell of grip `number` of the scene reads in each frame: its force or its torque.
MeasuredReaction LoadCellReading(const Scene& scene, const SceneMotion& motion, size_t number,
                                 size_t held, bool is_torque) {
  const SceneGrip& grip = scene.grips[number];
  MeasuredReaction reading;
  reading.name = grip.region.name;
  reading.held = held;
  reading.labels = {"x", "y", "z"};
  reading.directions = Eigen::Matrix3d::Identity();
  reading.is_torque = is_torque;
  reading.deviation = is_torque ? *grip.torque_deviation : *grip.force_deviation;
  reading.times = Eigen::Map<const Eigen::VectorXd>(motion.times.data(),
                                                    static_cast<Eigen::Index>(motion.times.size()));
  reading.values = (is_torque ? motion.torques : motion.reactions)
                       .middleRows<3>(3 * static_cast<Eigen::Index>(number));
  AddNormalNoise(reading.deviation,
                 {.seed = scene.scanner->options.seed,
                  .stream = is_torque ? kTorqueNoise : kForceNoise,
                  .number = number},
                 reading.values);
  return reading;
}

// Adds the grips that the recording names, and their load cells.
void AddGrips(const Scene& scene, const SceneMotion& motion, RecordedObject* object) {
  std::vector<std::pair<size_t, size_t>> cells;  // grip of the scene, held part of the recording
  for (const bool driven : {false, true}) {
    for (size_t k = 0; k < scene.grips.size(); ++k) {
      const SceneGrip& grip = scene.grips[k];
      const bool is_measured = grip.force_deviation || grip.torque_deviation;
      if (IsHeld(grip) == driven || (driven && !is_measured)) continue;
      if (is_measured) cells.emplace_back(k, object->fixed.size() + object->grips.size());
      if (driven)
        object->grips.push_back(DrivenGrip(scene, grip));
      else
        object->fixed.push_back({grip.region, grip.axes});
    }
  }
  for (const auto& [grip, held] : cells) {
    if (scene.grips[grip].force_deviation)
      object->reactions.push_back(LoadCellReading(scene, motion, grip, held, false));
    if (scene.grips[grip].torque_deviation)
      object->reactions.push_back(LoadCellReading(scene, motion, grip, held, true));
  }
}

}  // namespace

void WriteSceneRecording(const Scene& scene, const SceneMotion& motion,
                         const std::filesystem::path& folder) {
  CHECK(motion.IsUsable() && scene.scanner.has_value());
  RecordedObject object;
  object.density = scene.density;
  AddGrips(scene, motion, &object);
  object.gravity = GravityOf(scene.effects);
  for (const SceneLoad& load : scene.loads) {
    if (!load.measured) continue;
    MeasuredForce force;
    force.name = load.region.name;
    force.region = load.region;
    force.times = Eigen::Map<const Eigen::VectorXd>(motion.times.data(),
                                                    static_cast<Eigen::Index>(motion.times.size()));
    force.forces.resize(3, force.times.size());
    for (Eigen::Index k = 0; k < force.times.size(); ++k)
      force.forces.col(k) = load.profile.At(force.times[k]) * load.force;
    object.forces.push_back(force);
  }
  VirtualScan scan{{}, motion.times, PlaceCameras(scene.scanner->ring), scene.scanner->options};
  for (const Eigen::Matrix3Xd& nodes : motion.positions)
    scan.surfaces.push_back(BoundaryAt(motion.body->boundary, nodes));
  WriteScan(folder, scene.name, object, scan, WritePointFrames);
}

}  // namespace lacuna
