#include "fem/missing_mass.h"

#include <fmt/format.h>

#include <vector>

#include "fem/step_equation.h"

namespace lacuna {
namespace {

// The mass that an effect adds to each node, kg: the smallest diagonal entry of −∂f/∂a; 0 where the
// effect is not defined at rest, as some laws of the user.
Eigen::VectorXd AddedMassOf(const Effect& effect, const Model& model, const MotionHistory& rest,
                            const Eigen::VectorXd& state) {
  const Eigen::VectorXd still = Eigen::VectorXd::Zero(rest.position.size());
  BlockMatrix inertia(model.body->pattern);
  effect.AddTangents({.body = *model.body,
                      .position = rest.position,
                      .velocity = still,
                      .acceleration = still,
                      .state = state,
                      .elasticity = ElasticityOf(model),
                      .has_inertia = true},
                     {.acceleration = -1}, /*convexify=*/false, &inertia);
  Eigen::VectorXd mass(model.body->NodeCount());
  for (Eigen::Index i = 0; i < mass.size(); ++i) {
    const auto block = inertia.Block(inertia.pattern().diagonal[static_cast<size_t>(i)]);
    mass[i] = block.allFinite() ? block.diagonal().minCoeff() : 0;
  }
  return mass;
}

}  // namespace

std::string DescribeMissingMass(const Model& model) {
  constexpr double kGram = 1e-3, kMillimetre = 1e-3;
  const Eigen::VectorXd& own = model.body->node_mass;
  const MotionHistory rest = RestHistory(model);
  std::vector<Eigen::VectorXd> added;
  Eigen::VectorXd total = own;
  for (size_t j = 0; j < model.effects.size(); ++j) {
    added.push_back(AddedMassOf(*model.effects[j], model, rest, rest.effect_state[j]));
    total += added.back();
  }
  Eigen::Index node = 0;
  // A node without elements has no mass and needs none.
  const Eigen::ArrayXd share = (own.array() > 0).select(total.array() / own.array(), 1);
  if (share.minCoeff(&node) > 0) return "";
  size_t worst = 0;
  for (size_t j = 1; j < added.size(); ++j)
    if (added[j][node] < added[worst][node]) worst = j;
  const Effect& effect = *model.effects[worst];
  const ParameterCard& size = effect.Card().parameters.front();
  const Eigen::Vector3d place = model.body->mesh.nodes.col(node) / kMillimetre;
  return fmt::format(
      "{} with a {} of {:.3g} {} removes {:.3g} g at ({:.3g}, {:.3g}, {:.3g}) mm, where the body "
      "has {:.3g} g at a node of its mesh: the mass must be positive everywhere",
      effect.Card().type, size.name, effect.Parameters()[0], size.dimension.unit,
      -added[worst][node] / kGram, place.x(), place.y(), place.z(), own[node] / kGram);
}

}  // namespace lacuna
