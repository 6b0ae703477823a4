#include "fem/model.h"

namespace lacuna {

const Effect* ElasticityOf(const Model& model) {
  return model.effects.empty() ? nullptr : model.effects.front().get();
}

std::vector<char> GrippedNodes(const Model& model) {
  std::vector<char> gripped(model.body->NodeCount(), 0);
  for (const Grip& grip : model.grips)
    for (const int node : grip.nodes) gripped[node] = 1;
  return gripped;
}

}  // namespace lacuna
