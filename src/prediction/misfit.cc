#include "prediction/misfit.h"

namespace lacuna {

Eigen::VectorXd Misfit::ResidualWithout(const Eigen::MatrixXd& place_offset) const {
  Eigen::VectorXd rest = residual;
  const Eigen::Index components = Components();
  for (size_t at = 0; at < count.size(); ++at) {
    const int point = static_cast<int>(at) % points;
    if (count[at] == 0) continue;
    auto row = rest.segment(components * static_cast<Eigen::Index>(at), components);
    if (deformation.empty())
      row -= place_offset.col(point);
    else
      row -= deformation[at] * place_offset.col(point);
  }
  return rest;
}

}  // namespace lacuna
