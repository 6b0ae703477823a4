// Figure 1 of Transue & Choi 2015: one body dropped on a floor, simulated on meshes of different
// sizes; here with the numbers in which they differ.
//
// The scene is an ordinary one (experiment/scene.h) with gravity and a floor along z, whose bar
// falls from the start. Each mesh replaces the scene's, takes its time steps, and takes them again
// halved.
#ifndef LACUNA_PAPER_DROP_STUDY_H_
#define LACUNA_PAPER_DROP_STUDY_H_

#include <string>
#include <vector>

#include "core/config.h"
#include "core/progress.h"
#include "experiment/scene.h"
#include "record/run_record.h"

namespace lacuna {

struct DropMesh {
  int paper_nodes = 0;     // the number that it comes close to
  double edge_length = 0;  // m, of the surface's triangles
  MeshSettings settings;
};

struct DropStudy {
  Scene scene;
  std::vector<DropMesh> meshes;
  std::vector<double> instants;  // s, to be drawn
};
// Throws InputError; also for a scene without floor or gravity.
DropStudy ReadDrop(const Config& config);

// Of the first bounce. What is not reached in the scene's time is not measured.
struct DropNumbers {
  double touch_time = kNotMeasured;      // s, when the lowest node meets the floor
  double contact_time = kNotMeasured;    // s, until the last node has left it
  double compression = kNotMeasured;     // largest loss of height, of the height at rest
  double peak_force = kNotMeasured;      // N, of the floor
  double rebound_speed = kNotMeasured;   // m/s, of the centre of mass when the body leaves
  double rebound_height = kNotMeasured;  // m, to which the centre then rises, above where it is
                                         // when the undeformed body stands on the floor
  double frequency = kNotMeasured;       // Hz, at which the body's height swings most in flight
  // The largest rise of the total energy over what it was before, and its end, both in parts of the
  // kinetic energy at the start.
  double energy_growth = kNotMeasured;
  double energy_left = kNotMeasured;
};
// The motion must be usable, with frames close enough to tell its swing.
DropNumbers MeasureDrop(const Scene& scene, const SceneMotion& motion);

struct DropRun {
  DropMesh mesh;
  SceneMotion motion;  // at the scene's steps
  DropNumbers numbers;
  DropNumbers halved;  // with steps of half the length
};
// The scene with the mesh and steps of one run.
Scene SceneOf(const DropStudy& study, const DropMesh& mesh, int step_divisor);

// Throws Interrupted, and InputError where a mesh or a step fails.
std::vector<DropRun> RunDrop(const DropStudy& study, Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_PAPER_DROP_STUDY_H_
