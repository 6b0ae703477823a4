// A fitted model as plain data, from which a writer makes the files of another program.
//
// The effects that other programs know are classified; every other effect keeps its name, so that a
// writer can say what its format lacks. Lengths are in m, masses in kg, times in s, forces in N.
// Node numbers are those of the mesh, from 0.
#ifndef LACUNA_EXCHANGE_PORTABLE_MODEL_H_
#define LACUNA_EXCHANGE_PORTABLE_MODEL_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "fem/model.h"
#include "fem/prediction.h"
#include "geometry/tet_mesh.h"

namespace lacuna {

struct PortableEffect {
  enum class Kind {
    // Elasticity laws, of which a model has one; values: E (Pa), ν.
    kLinear,
    kCorotational,
    kSaintVenantKirchhoff,
    kNeoHookean,
    // Values: the acceleration, m/s².
    kGravity,
    // Values: α (1/s).
    kMassDamping,
    // Values: β (s), and E (Pa), ν of the stiffness that it refers to.
    kStiffnessDamping,
    // Values: m (Pa), τ (s), ν.
    kViscoelasticBranch,
    kOther
  };
  Kind kind = Kind::kOther;
  std::string name;        // the effect's name in the catalogue
  Eigen::VectorXd values;  // in the order of the effect's card, SI
  std::vector<std::string> value_names;
  // The mapping that describes the effect in an experiment, where the user has written a part of it
  // as an expression; otherwise empty.
  std::string yaml;

  bool IsElasticity() const { return kind <= Kind::kNeoHookean; }
};

struct NamedNodes {
  std::string name;
  std::vector<int> nodes;  // ascending
};

// A part with a prescribed motion.
struct PortableGrip {
  NamedNodes part;
  // For each time of PortableModel::times, the displacements of the nodes (3 × nodes); empty where
  // the part is clamped at its rest position.
  std::vector<Eigen::Matrix3Xd> displacements;
  AxisSet axes = AxisSet::All();  // the axes along which it is held

  // Whether all nodes have the same displacement at all times, up to rounding.
  bool IsTranslation() const;
  // A component of the displacement of one node of `part` at all times, m.
  Eigen::VectorXd Series(Eigen::Index axis, Eigen::Index node) const;
};

// A force that is spread over nodes with a fixed distribution.
struct PortableLoad {
  NamedNodes part;
  Eigen::VectorXd shares;  // of part.nodes, sum 1
  Eigen::Matrix3Xd force;  // 3 × times: the resultant
};

// A parameter of the fit, for people: "young_modulus", "Pa", 84721.13, and its 95 % interval.
struct PortableParameter {
  std::string name, unit;
  std::vector<double> values;
  bool fitted = false;
  double low = 0, high = 0;  // the 95 % interval of a fitted parameter
  // The value with infinitely fine elements and time steps, whose interval this is; absent where
  // it was not computed, so that the interval is that of the value itself.
  std::optional<double> at_limit = {};
};

// Damping forces α M v + β K v with the tangent stiffness K.
struct RayleighDamping {
  double alpha = 0, beta = 0;  // 1/s, s
};

struct PortableModel {
  std::string run, recording, experiment, program_version;
  std::vector<PortableParameter> parameters;

  TetMesh mesh;
  double density = 0;
  Eigen::VectorXd node_mass;            // n, lumped, as Lacuna uses them
  std::vector<PortableEffect> effects;  // the elasticity law first; without measured forces
  std::vector<NamedNodes> regions;      // the parts that the recording names, grips included
  std::vector<PortableGrip> grips;
  std::vector<PortableLoad> loads;
  // The force that holds the body until the motion starts, 3 × n; empty: none.
  Eigen::Matrix3Xd held_force;

  // The motion begins at times.front() with the equilibrium of the held body; these are the times
  // at which grips and loads are sampled. `frames` are the times at which the recording shows the
  // body. Both count from the start of the motion, which is at `start` on the model's clock.
  std::vector<double> times, frames;
  double start = 0;
  double time_step = 0;    // largest step of the simulation
  bool is_static = false;  // quasi-static: no inertia

  const PortableEffect& Elasticity() const { return effects.front(); }
  // The first effect of this kind, or null.
  const PortableEffect* Find(PortableEffect::Kind kind) const;
  // Whether the Poisson's ratio of stiffness damping or of a branch is that of the material, so
  // that its moduli are proportional to those of the material.
  bool IsProportional(const PortableEffect& effect) const;
  Eigen::Vector3d Gravity() const;  // m/s²
  // The damping of the effects that are proportional; β refers to the material's own modulus.
  RayleighDamping Damping() const;
  double Duration() const { return times.back(); }
  // Whether a motion with inertia follows the equilibrium at the start.
  bool HasInertia() const { return !is_static && !frames.empty(); }
};

// What the model of a recording is called, and what is exported of its motion.
struct PortableNames {
  std::vector<std::string> grips, loads;  // one name for each grip and each PrescribedForce
  std::vector<NamedNodes> regions = {};   // further ones
};

// Describes a model whose elements stand in `mesh` in the order in which they are exported. Frames
// (s, ascending, on the model's clock) before options.start_time are left out; where none remains
// the motion ends at its start. Where the density is fitted, the description has the fitted one,
// and α of mass-proportional damping for it. Provenance is left empty.
PortableModel DescribeModel(const Model& model, const TetMesh& mesh,
                            const PredictionOptions& options, const std::vector<double>& frames,
                            const PortableNames& names);

}  // namespace lacuna

#endif  // LACUNA_EXCHANGE_PORTABLE_MODEL_H_
