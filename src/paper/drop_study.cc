#include "paper/drop_study.h"

#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/json_number.h"
#include "effects/gravity.h"
#include "effects/plane_contact.h"

namespace lacuna {
namespace {

// The numbers by their names in JSON.
struct NamedNumber {
  const char* name;
  double DropNumbers::*value;
};
constexpr std::array<NamedNumber, 9> kNumbers{{
    {"touch_time_s", &DropNumbers::touch_time},
    {"contact_time_s", &DropNumbers::contact_time},
    {"compression", &DropNumbers::compression},
    {"peak_force_N", &DropNumbers::peak_force},
    {"rebound_speed_m_per_s", &DropNumbers::rebound_speed},
    {"rebound_height_m", &DropNumbers::rebound_height},
    {"frequency_Hz", &DropNumbers::frequency},
    {"energy_growth", &DropNumbers::energy_growth},
    {"energy_left", &DropNumbers::energy_left},
}};

bool IsAlongZ(const Eigen::Vector3d& vector) { return vector.x() == 0 && vector.y() == 0; }

// The measured quantities of one frame, SI.
struct DropState {
  double time = 0;
  double centre = 0, speed = 0;  // height and velocity of the centre of mass, along z
  double gap = 0;                // between the lowest node and the floor
  double height = 0;             // height of the body
  double force = 0;              // force of the floor on the body
  double kinetic = 0, energy = 0;
};

DropState StateAt(const Scene& scene, const SceneMotion& motion, size_t k) {
  const Effect& floor = *FindPlaneContact(scene.effects);
  const Body& body = *motion.body;
  const Eigen::VectorXd position = motion.positions[k].reshaped();
  const Eigen::VectorXd velocity = motion.velocities[k].reshaped();
  const Eigen::VectorXd no_acceleration = Eigen::VectorXd::Zero(position.size());
  const Eigen::VectorXd no_memory;
  const double time = motion.times[k];
  const Kinematics at{body, position, velocity, no_acceleration, time, 0, no_memory};
  const Eigen::VectorXd share = body.node_mass / body.node_mass.sum();
  DropState state;
  state.time = time;
  state.centre = motion.positions[k].row(2).dot(share);
  state.speed = motion.velocities[k].row(2).dot(share);
  const double lowest = motion.positions[k].row(2).minCoeff();
  state.gap = lowest - ContactPlaneOf(floor)->offset;
  state.height = motion.positions[k].row(2).maxCoeff() - lowest;
  Eigen::VectorXd push = Eigen::VectorXd::Zero(position.size());
  floor.AddForce(at, &push);
  state.force = push(Eigen::seq(2, Eigen::last, 3)).sum();
  state.kinetic = 0.5 * motion.velocities[k].colwise().squaredNorm().dot(body.node_mass);
  state.energy = state.kinetic;
  for (const auto& effect : scene.effects) state.energy += effect->Energy(at).value_or(0);
  return state;
}

double ZeroBetween(double t0, double v0, double t1, double v1) {
  return t0 + (t1 - t0) * v0 / (v0 - v1);
}

// The value at the vertex of the parabola through three even samples.
double Vertex(double before, double middle, double after) {
  const double curvature = before - 2 * middle + after;
  if (curvature == 0) return middle;
  const double slope = 0.5 * (after - before);
  return middle - 0.5 * slope * slope / curvature;
}

// The largest sample, refined by a parabola through it and its neighbours.
double Peak(const std::vector<DropState>& states, double (*value)(const DropState&)) {
  size_t peak = 0;
  for (size_t k = 0; k < states.size(); ++k)
    if (value(states[k]) > value(states[peak])) peak = k;
  if (peak == 0 || peak + 1 == states.size()) return value(states[peak]);
  return Vertex(value(states[peak - 1]), value(states[peak]), value(states[peak + 1]));
}

// The frequency at which the spectrum of the height is largest; its mean is subtracted and a Hann
// window applied.
double SwingFrequency(const std::vector<DropState>& flight) {
  constexpr size_t kFewest = 16;
  if (flight.size() < kFewest) return kNotMeasured;
  const auto count = static_cast<double>(flight.size());
  double mean = 0;
  for (const DropState& state : flight) mean += state.height / count;
  const double step = flight[1].time - flight[0].time;
  const double span = step * count;
  const auto power = [&](double frequency) {
    double re = 0, im = 0;
    for (size_t k = 0; k < flight.size(); ++k) {
      const auto place = static_cast<double>(k);
      const double window = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * (place + 0.5) / count);
      const double angle = 2 * std::numbers::pi * frequency * step * place;
      re += window * (flight[k].height - mean) * std::cos(angle);
      im += window * (flight[k].height - mean) * std::sin(angle);
    }
    return re * re + im * im;
  };
  // With fewer than 3/2 periods in the window an oscillation cannot be distinguished from a drift.
  const double resolution = 0.01 / span;
  double best = 1.5 / span, largest = 0;
  for (double f = best; f < 0.25 / step; f += resolution) {
    const double here = power(f);
    if (here > largest) {
      largest = here;
      best = f;
    }
  }
  return best;
}

}  // namespace

DropStudy ReadDrop(const Config& config) {
  DropStudy study;
  config.Integer("schema_version", 1, 1);
  const Config scene = Config::Load(config.Path("scene"));
  study.scene = ReadScene(scene);
  study.scene_configuration = scene.Resolved();
  const Effect* floor = FindPlaneContact(study.scene.effects);
  if (floor == nullptr || !IsAlongZ(ContactPlaneOf(*floor)->normal))
    config.Fail("scene", "has no plane_contact with a normal along z to fall on");
  const std::optional<Eigen::Vector3d> gravity = GravityOf(study.scene.effects);
  if (!gravity || !IsAlongZ(*gravity) || gravity->z() >= 0)
    config.Fail("scene", "has no gravity along -z");
  if (study.scene.bar.velocity.z() >= 0)
    config.Fail("scene", "has a bar that does not fall: bar.velocity");
  for (const Config& item : config.Items("meshes")) {
    DropMesh mesh;
    mesh.paper_nodes = item.Integer("paper_nodes", 1, 100000000);
    mesh.edge_length = item.Quantity("edge_length", kLength, kPositive);
    mesh.settings = ReadMeshSettings(item.Child("mesh"));
    study.meshes.push_back(mesh);
  }
  if (study.meshes.empty()) config.Fail("meshes", "is empty; expected a list of meshes");
  study.instants = config.Quantities("instants", kTime, kNotNegative);
  if (study.instants.empty()) config.Fail("instants", "is empty; expected a list of times");
  config.RefuseUnknownKeys();
  return study;
}

DropNumbers MeasureDrop(const Scene& scene, const SceneMotion& motion) {
  CHECK(motion.IsUsable());
  std::vector<DropState> states;
  for (size_t k = 0; k < motion.times.size(); ++k) states.push_back(StateAt(scene, motion, k));
  const DropState& start = states.front();
  DropNumbers numbers;

  double least = start.energy;
  numbers.energy_growth = 0;
  for (const DropState& state : states) {
    numbers.energy_growth = std::max(numbers.energy_growth, (state.energy - least) / start.kinetic);
    least = std::min(least, state.energy);
  }

  const auto touches = [](const DropState& state) { return state.gap <= 0; };
  const auto touch = std::find_if(states.begin(), states.end(), touches);
  if (touch == states.begin() || touch == states.end()) return numbers;
  const auto before = std::prev(touch);
  numbers.touch_time = ZeroBetween(before->time, before->gap, touch->time, touch->gap);
  numbers.compression =
      1 + Peak(states, [](const DropState& state) { return -state.height; }) / start.height;
  numbers.peak_force = Peak(states, [](const DropState& state) { return state.force; });
  const auto leave = std::find_if(states.rbegin(), states.rend(), touches).base();
  if (leave == states.end()) return numbers;
  const auto last = std::prev(leave);
  const double lift_off = ZeroBetween(last->time, last->gap, leave->time, leave->gap);
  numbers.contact_time = lift_off - numbers.touch_time;

  // In flight the centre moves on a parabola, which determines its speed at the start of the
  // flight.
  const double gravity = -GravityOf(scene.effects)->z();
  const DropState& end = states.back();
  const double flight = end.time - lift_off;
  numbers.rebound_speed = end.speed + gravity * flight;
  const double centre_at_lift_off = end.centre - (end.speed + 0.5 * gravity * flight) * flight;
  const double standing = start.centre - start.gap;
  numbers.rebound_height =
      centre_at_lift_off - standing + 0.5 * numbers.rebound_speed * numbers.rebound_speed / gravity;
  numbers.frequency = SwingFrequency({leave, states.end()});
  // The potential energy is zero for the body standing on the floor, so that the rest is the energy
  // of motion and strain.
  const double weight = motion.body->node_mass.sum() * gravity;
  const double height_energy = start.energy - start.kinetic - weight * start.gap;
  numbers.energy_left = (end.energy - height_energy) / start.kinetic;
  return numbers;
}

nlohmann::json ToJson(const DropNumbers& numbers) {
  nlohmann::json json;
  for (const NamedNumber& number : kNumbers)
    json[number.name] = NumberOrNull<nlohmann::json>(numbers.*number.value);
  return json;
}

DropNumbers DropNumbersFrom(const nlohmann::json& json) {
  DropNumbers numbers;
  for (const NamedNumber& number : kNumbers) numbers.*number.value = NumberOr(json.at(number.name));
  return numbers;
}

Scene SceneOf(const DropStudy& study, const DropMesh& mesh, int step_divisor) {
  Scene scene = study.scene;
  scene.bar.edge_length = mesh.edge_length;
  scene.mesh = mesh.settings;
  scene.steps_per_frame *= step_divisor;
  return scene;
}

}  // namespace lacuna
