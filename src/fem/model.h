// A body, the effects that act on it and the grips that hold it: all that a simulation needs.
#ifndef LACUNA_FEM_MODEL_H_
#define LACUNA_FEM_MODEL_H_

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "fem/body.h"
#include "fem/effect.h"

namespace lacuna {

// Nodes whose motion is prescribed: clamped where they rest, or moved with a measured grip.
struct Grip {
  Eigen::VectorXi nodes;
  // Positions of these nodes at a time (3 × nodes.size(), m). Empty: held at rest.
  std::function<Eigen::Matrix3Xd(double time)> motion;
};

// Effects do not change, so that models share them.
using EffectList = std::vector<std::shared_ptr<const Effect>>;

struct Model {
  std::shared_ptr<const Body> body;
  EffectList effects;
  std::vector<Grip> grips;
};

// n: 1 at nodes that a grip holds.
std::vector<char> GrippedNodes(const Model& model);

}  // namespace lacuna

#endif  // LACUNA_FEM_MODEL_H_
