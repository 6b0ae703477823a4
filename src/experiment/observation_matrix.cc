#include "experiment/observation_matrix.h"

namespace lacuna {

Eigen::MatrixXd ObservationMatrix::operator*(const Eigen::Ref<const Eigen::MatrixXd>& nodal) const {
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(Count(), nodal.cols());
  for (Eigen::Index k = 0; k < nodal.cols(); ++k)
    for (int row = 0; row < Count(); ++row)
      for (int entry = begin[row]; entry < begin[row + 1]; ++entry)
        product(row, k) += weight[entry] * nodal(column[entry], k);
  return product;
}

}  // namespace lacuna
