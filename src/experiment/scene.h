// A synthetic scene: a soft bar that is held, loaded, moved or dropped, and a virtual scanner.
//
// Scenes make recordings whose truth is known. A reconstruction should not explain data with the
// discretisation that made them. A scene therefore uses a finer mesh, elements of higher order and
// shorter steps. Its result is an ordinary recording, and the truth is kept in a separate folder.
#ifndef LACUNA_EXPERIMENT_SCENE_H_
#define LACUNA_EXPERIMENT_SCENE_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/config.h"
#include "core/progress.h"
#include "experiment/model_reader.h"
#include "fem/nodal_recovery.h"
#include "fem/stepper.h"
#include "scan/virtual_scanner.h"

namespace lacuna {

struct BarShape {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();         // m
  Eigen::Vector3d size = Eigen::Vector3d(0.1, 0.03, 0.03);  // m
  double edge_radius = 0.004;                               // m
  double edge_length = 0.006;  // m, surface triangles; smaller: finer and slower
  Eigen::Vector3d axis = Eigen::Vector3d::UnitY();  // axis of its rotation about its centre
  double angle = 0;                                 // rad
  // The velocity of all points at the start, m/s: √(2gh) downwards after a fall from height h.
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
};

// A force spread over the boundary nodes of a region in proportion to area.
struct SceneLoad {
  Region region;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, total force
  Profile profile;
  bool measured = false;  // the recording contains it, as if from a load cell
};

// Nodes that are held, or moved as a rigid body: a rotation about an axis and a translation, both
// multiplied by the profile.
struct SceneGrip {
  Region region;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // m
  double angle = 0;                                  // rad
  Profile profile;
  AxisSet axes = AxisSet::All();  // along which it is held; all if it rotates
  // N and N m, noise of a component of the load cells that measure its force and its torque about
  // the mean of its undeformed nodes; absent: there is none.
  std::optional<double> force_deviation, torque_deviation;
};

struct Scene {
  std::string name;
  BarShape bar;
  MeshSettings mesh;
  double density = 1000;  // kg/m³
  EffectList effects;
  std::vector<SceneGrip> grips;
  std::vector<SceneLoad> loads;
  StepOptions step;
  double frame_rate = 30;   // 1/s
  int frames = 1;           // the first one at time 0
  int steps_per_frame = 4;  // larger: more accurate in time, slower
  // If it is absent, the scene is simulated but not recorded.
  struct Scanner {
    CameraRing ring;
    ScannerOptions options;
  };
  std::optional<Scanner> scanner;
};

// Throws InputError, also for unknown keys.
Scene ReadScene(const Config& config);

struct SceneMotion {
  enum class Status { kNotRun, kFinished, kMeshFailed, kStepFailed };
  Status status = Status::kNotRun;
  std::string message;
  std::shared_ptr<const Body> body;
  std::vector<double> times;                 // s, one per frame
  std::vector<Eigen::Matrix3Xd> positions;   // 3 × nodes, m, one per frame
  std::vector<Eigen::Matrix3Xd> velocities;  // m/s
  std::vector<Eigen::Vector3d> load;         // N, total of the loads, one per frame
  std::vector<NodalStress> stress;           // in each frame
  // 3·grips × frames, N and N m: the force of each grip on the body, and its torque about the mean
  // of the grip's undeformed nodes.
  Eigen::MatrixXd reactions, torques;
  bool IsUsable() const { return status == Status::kFinished; }
};

// Raised whenever a change of the code changes the motion of a scene or the recording that is made
// of it: the body, its mesh, the time steps, the scanner. What is kept of a scene is kept under it.
inline constexpr int kSceneVersion = 1;

// A mesh or a step that fails is reported by the status. Throws Interrupted, and OutOfMemory
// (core/memory_limit.h).
SceneMotion SimulateScene(const Scene& scene, Progress* progress);
// SimulateScene() where nothing can be done without the motion: a failure is an InputError, which
// names the scene.
SceneMotion SimulateWholeScene(const Scene& scene, Progress* progress);

// Writes what the scanner sees as a recording into `folder`, and the true surfaces into its
// subfolder truth (scan/scan_writer.h). The recording names the regions that are fixed but not
// those that move, unless a load cell measures their force: it then has their path too. Throws
// InputError when it cannot be written.
void WriteSceneRecording(const Scene& scene, const SceneMotion& motion,
                         const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_SCENE_H_
