#include "search/ordered_algebra.h"

#include <cmath>

namespace lacuna {

Eigen::VectorXd OrderedProduct(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& vector) {
  Eigen::VectorXd product(matrix.rows());
  for (int i = 0; i < matrix.rows(); ++i) product[i] = OrderedDot(matrix.row(i), vector);
  return product;
}

std::optional<Eigen::MatrixXd> OrderedInverse(Eigen::MatrixXd matrix) {
  const int n = static_cast<int>(matrix.rows());
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(n, n);
  const Eigen::VectorXd scale = matrix.cwiseAbs().colwise().maxCoeff();
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i) {
      if (std::abs(matrix(i, k)) > std::abs(matrix(pivot, k))) pivot = i;
    }
    if (!(std::abs(matrix(pivot, k)) > 1e-14 * scale[k])) return std::nullopt;
    matrix.row(k).swap(matrix.row(pivot));
    inverse.row(k).swap(inverse.row(pivot));
    const double factor = matrix(k, k);
    for (int j = 0; j < n; ++j) {
      matrix(k, j) /= factor;
      inverse(k, j) /= factor;
    }
    for (int i = 0; i < n; ++i) {
      const double multiple = matrix(i, k);
      if (i == k || multiple == 0) continue;
      for (int j = 0; j < n; ++j) {
        matrix(i, j) -= multiple * matrix(k, j);
        inverse(i, j) -= multiple * inverse(k, j);
      }
    }
  }
  return inverse;
}

}  // namespace lacuna
