#include "search/simplex.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "search/ordered_algebra.h"

namespace lacuna {
namespace {

using Eigen::VectorXd;

// The step along axis i that the bounds allow: `wanted` if it lies within them, otherwise the
// opposite step if that does, otherwise the longest step to either side.
double AxisStep(const VectorXd& x, int i, double wanted, const Evaluator& evaluator) {
  const double above = evaluator.upper()[i] - x[i];
  const double below = x[i] - evaluator.lower()[i];
  const double size = std::abs(wanted);
  if ((wanted > 0 ? above : below) >= size) return wanted;
  if ((wanted > 0 ? below : above) >= size) return -wanted;
  return above >= below ? above : -below;
}

// The start, or, if its evaluation fails, the first neighbour whose evaluation succeeds. Neighbours
// are tried on both sides along each axis, at distances of up to one and a half radii.
std::optional<VectorXd> FirstSuccess(const VectorXd& start, double radius, Evaluator* evaluator) {
  const Evaluation* outcome = evaluator->At(start);
  if (outcome == nullptr || outcome->value) return outcome ? std::optional(start) : std::nullopt;
  for (const double factor : {1.0, -1.0, 0.5, -0.5, 1.5, -1.5}) {
    for (int i = 0; i < start.size(); ++i) {
      const VectorXd x =
          evaluator->Within(start + factor * radius * VectorXd::Unit(start.size(), i));
      outcome = evaluator->At(x);
      if (outcome == nullptr) return std::nullopt;
      if (outcome->value) return x;
    }
  }
  return std::nullopt;
}

}  // namespace

Simplex::Simplex(int n, int m)
    : vertices_(n, n + 1), values_(n + 1), violations_(n + 1), constraints_(m, n + 1) {}

std::optional<Simplex> Simplex::Around(const VectorXd& start, double step, Evaluator* evaluator) {
  const double radius = std::abs(step);
  const int n = evaluator->n();
  const std::optional<VectorXd> first = FirstSuccess(start, radius, evaluator);
  if (!first) return std::nullopt;
  Simplex simplex(n, evaluator->m());
  simplex.Replace(n, *first, *evaluator->At(*first));
  double worst = simplex.values_[n];
  double best = worst;
  std::vector<int> failed;  // vertices without an evaluation that succeeded
  for (int j = 0; j < n; ++j) {
    const VectorXd base = simplex.Vertex(n);
    const double along = AxisStep(base, j, step, *evaluator);
    const Evaluation* outcome = nullptr;
    VectorXd x;  // the neighbour that was tried last
    for (const double factor : {1.0, -1.0, 0.5, -0.5}) {
      const VectorXd neighbour = evaluator->Within(base + factor * along * VectorXd::Unit(n, j));
      if (neighbour == base) continue;
      x = neighbour;
      outcome = evaluator->At(x);
      if (outcome == nullptr) return std::nullopt;
      if (outcome->value) break;
    }
    if (outcome == nullptr) return std::nullopt;  // the range is too narrow for a second point
    if (outcome->value) {
      simplex.Replace(j, x, *outcome);
      worst = std::max(worst, *outcome->value);
      best = std::min(best, *outcome->value);
      if (*outcome->value < simplex.values_[n]) {
        const Evaluation base_outcome = *evaluator->At(base);
        simplex.Replace(n, x, *outcome);
        simplex.Replace(j, base, base_outcome);
      }
    } else {
      failed.push_back(j);
      simplex.vertices_.col(j) = x;
    }
  }
  // Only now are all values known.
  const double stand_in = worst + (worst - best) + 1e-3 * std::abs(worst);
  for (const int j : failed)
    simplex.Replace(j, simplex.Vertex(j), {stand_in, simplex.Constraints(n), ""});
  return simplex;
}

void Simplex::Replace(int j, const VectorXd& x, const Evaluation& outcome) {
  vertices_.col(j) = x;
  values_[j] = *outcome.value;
  constraints_.col(j) = outcome.constraints;
  violations_[j] = Violation(outcome.constraints);
}

bool Simplex::IsBetter(int j, int k, double penalty) const {
  const double merit = Merit(j, penalty), other = Merit(k, penalty);
  return merit < other || (merit == other && penalty == 0 && violations_[j] < violations_[k]);
}

bool Simplex::MovePole(double penalty) {
  int best = n();
  for (int j = 0; j < n(); ++j)
    if (IsBetter(j, best, penalty)) best = j;
  if (best != n()) {
    vertices_.col(best).swap(vertices_.col(n()));
    constraints_.col(best).swap(constraints_.col(n()));
    std::swap(values_[best], values_[n()]);
    std::swap(violations_[best], violations_[n()]);
  }
  return Refresh();
}

bool Simplex::Refresh() {
  offsets_ = vertices_.leftCols(n()).colwise() - vertices_.col(n());
  std::optional<Eigen::MatrixXd> inverse = OrderedInverse(offsets_);
  if (!inverse) return false;
  inverse_ = *std::move(inverse);
  edge_lengths_.resize(n());
  face_distances_.resize(n());
  for (int j = 0; j < n(); ++j) {
    edge_lengths_[j] = OrderedNorm(offsets_.col(j));
    face_distances_[j] = 1 / OrderedNorm(inverse_.row(j));
  }
  model_.value = values_[n()];
  model_.constraints = constraints_.col(n());
  model_.gradient = VectorXd::Zero(n());
  model_.jacobian = Eigen::MatrixXd::Zero(constraints_.rows(), n());
  for (int j = 0; j < n(); ++j) {
    model_.gradient += (values_[j] - values_[n()]) * inverse_.row(j).transpose();
    for (int k = 0; k < constraints_.rows(); ++k) {
      model_.jacobian.row(k) += (constraints_(k, j) - constraints_(k, n())) * inverse_.row(j);
    }
  }
  return model_.gradient.allFinite() && model_.jacobian.allFinite();
}

double Simplex::Lagrange(int j, const VectorXd& step) const {
  return OrderedDot(inverse_.row(j), step);
}

VectorXd Simplex::GeometryPoint(int j, double length, double penalty,
                                const Evaluator& evaluator) const {
  const VectorXd step = length * FaceNormal(j);
  const VectorXd change = OrderedProduct(model_.jacobian, step);
  const double slope = OrderedDot(model_.gradient, step);
  const double ahead = slope + penalty * Violation(model_.constraints + change);
  const double behind = -slope + penalty * Violation(model_.constraints - change);
  const double side = ahead > behind ? -1 : 1;
  const VectorXd preferred = evaluator.Within(vertices_.col(n()) + side * step);
  const VectorXd other = evaluator.Within(vertices_.col(n()) - side * step);
  const auto height = [&](const VectorXd& x) {
    return std::abs(Lagrange(j, x - vertices_.col(n()))) * face_distances_[j];
  };
  return height(preferred) < 0.5 * length && height(other) > height(preferred) ? other : preferred;
}

bool Simplex::ReplaceByGeometryPoint(int j, double length, double penalty, Evaluator* evaluator) {
  const VectorXd pole = Vertex(n());
  const VectorXd step = GeometryPoint(j, length, penalty, *evaluator) - pole;
  for (const double factor : {1.0, -1.0, 0.5}) {
    const VectorXd x = evaluator->Within(pole + factor * step);
    if (x == pole || x == Vertex(j)) continue;
    const Evaluation* outcome = evaluator->At(x);
    if (outcome == nullptr) return false;
    if (!outcome->value) continue;
    Replace(j, x, *outcome);
    return true;
  }
  return false;
}

double Simplex::PenaltyLimit() const {
  double least_range = 0;
  for (int k = 0; k < constraints_.rows(); ++k) {
    const double lowest = constraints_.row(k).minCoeff();
    const double highest = constraints_.row(k).maxCoeff();
    if (lowest >= 0.5 * highest) continue;
    const double range = std::max(highest, 0.0) - lowest;
    least_range = least_range > 0 ? std::min(least_range, range) : range;
  }
  return least_range > 0 ? (values_.maxCoeff() - values_.minCoeff()) / least_range : 0;
}

}  // namespace lacuna
