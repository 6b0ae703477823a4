// A model: a body, the effects that act on it and the grips that prescribe the motion of nodes.
//
// It contains all that a simulation needs besides the initial state and the options of the solver.
#ifndef LACUNA_FEM_MODEL_H_
#define LACUNA_FEM_MODEL_H_

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "fem/body.h"
#include "fem/effect.h"
#include "geometry/axis_set.h"

namespace lacuna {

// Nodes with a prescribed motion: clamped at their places in the rest shape, or moved. A support
// along some axes only, such as a plane of symmetry, leaves the nodes free along the others, where
// it exerts no force.
struct Grip {
  Eigen::VectorXi nodes;
  // The positions of these nodes (3 × nodes.size(), m) as a function of time (s). Empty: clamped.
  // It is called from the thread of the simulation.
  std::function<Eigen::Matrix3Xd(double time)> motion;
  AxisSet axes = AxisSet::All();  // the axes along which the motion is prescribed
};

// Effects do not change, so that models share them.
using EffectList = std::vector<std::shared_ptr<const Effect>>;

// Copies are cheap: they share the body and the effects.
struct Model {
  std::shared_ptr<const Body> body;
  EffectList effects;  // the elasticity law first
  std::vector<Grip> grips;
};

// The elasticity law of the body, owned by the model; null for a model without effects.
const Effect* ElasticityOf(const Model& model);

// Young's modulus, Pa, of the elasticity law; that of kReferenceBody (record/effect_card.h) where
// the law has none.
double YoungModulusOf(const EffectList& effects);

// One flag per node: 1 where grips prescribe the motion along all axes.
std::vector<char> GrippedNodes(const Model& model);

// For each node, the axes along which grips prescribe its motion.
std::vector<AxisSet> HeldAxes(const Model& model);

}  // namespace lacuna

#endif  // LACUNA_FEM_MODEL_H_
