// A standard problem: a body, its supports and loads, what is wanted, and the published value.
//
// The files in problems/ are in the format that ReadProblem describes; docs/verification.md says
// how to run them. All numbers are in SI units.
#ifndef LACUNA_STANDARD_PROBLEM_H_
#define LACUNA_STANDARD_PROBLEM_H_

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "experiment/model_reader.h"
#include "fem/model.h"
#include "fem/time_scheme.h"
#include "geometry/axis_set.h"
#include "standard/mapped_block.h"

namespace lacuna {

// A part that is held along some axes, at rest or with a motion: a rotation about the z axis
// through `centre` and a translation, both multiplied by the profile.
struct ProblemSupport {
  std::string name;
  BlockPart part;
  AxisSet axes = AxisSet::All();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero(), centre = Eigen::Vector3d::Zero();
  double angle = 0;
  Profile profile;
  bool Moves() const { return angle != 0 || !translation.isZero(0); }
};

// A traction on faces of the block, or a total force that is uniform along an edge.
struct ProblemLoad {
  BlockPart part;
  Eigen::Vector3d traction = Eigen::Vector3d::Zero();    // Pa
  Eigen::Vector3d line_force = Eigen::Vector3d::Zero();  // N
  Profile profile;
};

enum class ProblemKind {
  kStatic,       // the equilibrium
  kModes,        // natural frequencies at rest
  kQuasiStatic,  // equilibria in steps from rest, with rate-dependent effects
  kMotion        // steps with inertia from the rest shape and an initial velocity
};

// What is computed and compared with the published value, at a time of the motion.
struct Wanted {
  enum class Kind {
    kDisplacement,  // of a point, along an axis, m
    kStress,        // Cauchy, of a point, Pa
    kVonMises,
    kReaction,   // of a support, along an axis, N
    kTorque,     // of a support, about the z axis through `centre`, N m
    kFrequency,  // of a mode, Hz
    kVelocity,   // of the centre of mass, along an axis, m/s
    kEnergy      // kinetic and potential energy over that at the start
  };
  Kind kind = Kind::kDisplacement;
  std::string name;   // "displacement_y"
  std::string label;  // distinguishes quantities of the same name; may be empty
  int component = 0;  // axis, or of the stress xx, yy, zz, yz, xz, xy
  BlockPart point;
  std::string support;
  int mode = 1;      // 1 is the lowest
  double time = 0;   // s; 0: the end of the motion
  double value = 0;  // published
  std::string unit;  // in which values are shown; empty for a plain number
  double scale = 1;  // 1 of that unit in SI units
};

// The error that another program has on the same problem, with its source.
struct PeerResult {
  std::string program;
  double value = 0;
  size_t wanted = 0;  // index in Problem::wanted
  std::string source;
};

struct ProblemMesh {
  std::array<int, 3> cells = {1, 1, 1};
  int steps = 1;  // of a motion
};

struct Problem {
  std::string name, title, source, remark;
  BlockMap map;
  std::vector<int> orders;  // of the elements
  EffectList effects;       // material first
  double density = 1;
  std::vector<ProblemSupport> supports;
  std::vector<ProblemLoad> loads;
  ProblemKind kind = ProblemKind::kStatic;
  double duration = 0;
  TimeScheme scheme = TimeScheme::kTwoStep;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  std::vector<Wanted> wanted;
  std::vector<PeerResult> peers;
  std::vector<ProblemMesh> meshes;  // each finer than the one before
  int quick = 1;                    // so many of the meshes belong to the quick set
  // The file of published values that is absent, because the data are not part of the project; the
  // values that come from it are NaN, and the problem cannot be compared. Otherwise empty.
  std::filesystem::path missing_data;
  // Largest relative error on the last mesh of the quick set, for each order of elements.
  std::vector<double> tolerances;
};

// Throws InputError with file, line and field.
Problem ReadProblem(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_STANDARD_PROBLEM_H_
