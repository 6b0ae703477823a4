#include "fem/model.h"

namespace lacuna {

const Effect* ElasticityOf(const Model& model) {
  return model.effects.empty() ? nullptr : model.effects.front().get();
}

double YoungModulusOf(const EffectList& effects) {
  if (effects.empty()) return kReferenceBody.young_modulus;
  const int index = ParameterIndex(effects.front()->Card(), "young_modulus");
  return index < 0 ? kReferenceBody.young_modulus : effects.front()->Parameters()[index];
}

std::vector<char> GrippedNodes(const Model& model) {
  std::vector<char> gripped;
  for (const AxisSet held : HeldAxes(model)) gripped.push_back(held.IsAll());
  return gripped;
}

std::vector<AxisSet> HeldAxes(const Model& model) {
  std::vector<AxisSet> held(model.body->NodeCount());
  for (const Grip& grip : model.grips)
    for (const int node : grip.nodes) held[node] = held[node] | grip.axes;
  return held;
}

}  // namespace lacuna
