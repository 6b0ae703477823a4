// Figure 1 of Transue & Choi 2015: one body dropped on a floor, simulated on meshes of different
// sizes, with the quantities in which the simulations differ.
//
// The scene is an ordinary one (experiment/scene.h) with gravity and a floor normal to z, whose bar
// falls from the start. It is simulated once with each mesh at the time step of the scene, and once
// more at half of that step (paper/drop_run.h). All quantities are in SI units.
#ifndef LACUNA_PAPER_DROP_STUDY_H_
#define LACUNA_PAPER_DROP_STUDY_H_

#include <nlohmann/json.hpp>
#include <vector>

#include "core/config.h"
#include "experiment/scene.h"
#include "record/run_record.h"

namespace lacuna {

struct DropMesh {
  int paper_nodes = 0;     // the node count of the mesh of the paper that it approximates
  double edge_length = 0;  // m, of the surface's triangles
  MeshSettings settings;
};

struct DropStudy {
  Scene scene;
  nlohmann::json scene_configuration;  // the scene's file, with defaults resolved, in SI units
  std::vector<DropMesh> meshes;
  std::vector<double> instants;  // s, to be drawn
};
// The scene of the study must have a floor, gravity along −z and a falling bar. Throws InputError
// at the key that is wrong.
DropStudy ReadDrop(const Config& config);

// Quantities of the first bounce. One that the simulated time does not reach is kNotMeasured.
struct DropNumbers {
  double touch_time = kNotMeasured;      // s, when the lowest node meets the floor
  double contact_time = kNotMeasured;    // s, until the last node has left it
  double compression = kNotMeasured;     // largest loss of height, of the height at rest
  double peak_force = kNotMeasured;      // N, of the floor
  double rebound_speed = kNotMeasured;   // m/s, of the centre of mass when the body leaves
  double rebound_height = kNotMeasured;  // m, to which the centre then rises, above where it is
                                         // when the undeformed body stands on the floor
  double frequency = kNotMeasured;       // Hz, at which the body's height swings most in flight
  // The largest rise of the total energy above an earlier value, and its final value, both as
  // shares of the kinetic energy at the start.
  double energy_growth = kNotMeasured;
  double energy_left = kNotMeasured;
};
// The motion must be usable (CHECK). Its frames must be close enough to resolve the oscillation of
// the body.
DropNumbers MeasureDrop(const Scene& scene, const SceneMotion& motion);

// With the unit in the name of each number; null stands for kNotMeasured.
nlohmann::json ToJson(const DropNumbers& numbers);
// Throws nlohmann::json::exception if a number is absent.
DropNumbers DropNumbersFrom(const nlohmann::json& json);

// The scene with the mesh of one run and its time steps divided by `step_divisor`.
Scene SceneOf(const DropStudy& study, const DropMesh& mesh, int step_divisor);

}  // namespace lacuna

#endif  // LACUNA_PAPER_DROP_STUDY_H_
