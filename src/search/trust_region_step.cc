#include "search/trust_region_step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "search/ordered_algebra.h"

namespace lacuna {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// A constraint normal·d >= bound + rate·τ with a unit normal.
struct Row {
  VectorXd normal;
  double bound = 0;
  double rate = 0;
};

// The QR decomposition N = Q R of the normals of the active rows.
struct Basis {
  std::vector<VectorXd> q;
  MatrixXd r;

  Basis(const std::vector<Row>& rows, const std::vector<int>& active) {
    const int k = static_cast<int>(active.size());
    r = MatrixXd::Zero(k, k);
    for (int j = 0; j < k; ++j) {
      VectorXd normal = rows[active[j]].normal;
      // The second pass removes the rounding errors of the first.
      for (int pass = 0; pass < 2; ++pass) {
        for (int i = 0; i < j; ++i) {
          const double part = OrderedDot(q[i], normal);
          r(i, j) += part;
          normal -= part * q[i];
        }
      }
      r(j, j) = OrderedNorm(normal);
      q.push_back(normal / r(j, j));
    }
  }

  int size() const { return static_cast<int>(q.size()); }

  VectorXd WithoutNormals(VectorXd vector) const {
    for (int pass = 0; pass < 2; ++pass) {
      for (const VectorXd& direction : q) vector -= OrderedDot(direction, vector) * direction;
    }
    return vector;
  }

  // Returns R⁻¹ u.
  VectorXd SolveUpper(VectorXd u) const {
    for (int i = size() - 1; i >= 0; --i) {
      for (int j = i + 1; j < size(); ++j) u[i] -= r(i, j) * u[j];
      u[i] /= r(i, i);
    }
    return u;
  }

  // Returns R⁻ᵀ u.
  VectorXd SolveLower(VectorXd u) const {
    for (int i = 0; i < size(); ++i) {
      for (int j = 0; j < i; ++j) u[i] -= r(j, i) * u[j];
      u[i] /= r(i, i);
    }
    return u;
  }

  // Returns the y that minimises ‖N y − vector‖.
  VectorXd Coordinates(const VectorXd& vector) const {
    VectorXd u(size());
    for (int i = 0; i < size(); ++i) u[i] = OrderedDot(q[i], vector);
    return SolveUpper(u);
  }
};

enum class PathEnd { kParameter, kRadius, kBlocked };

// Follows the minimiser d of ½‖d‖² + τ h·d subject to the rows as τ grows.
class Path {
 public:
  Path(int n, double radius) : radius_(radius), d_(VectorXd::Zero(n)) {}

  std::vector<Row>& rows() { return rows_; }
  const VectorXd& d() const { return d_; }

  // Fixes the rows at the current parameter τ and resets τ to 0.
  void Freeze() {
    for (Row& row : rows_) {
      row.bound += row.rate * parameter_;
      row.rate = 0;
    }
    parameter_ = 0;
  }

  // Follows the path to τ = `end`, to the radius, or to where no step is possible.
  PathEnd Follow(const VectorXd& h, double end) {
    const int cap = 100 * (static_cast<int>(rows_.size()) + 1);
    for (int change = 0; change < cap; ++change) {
      const Basis basis(rows_, active_);
      const Rates rates = RatesOf(h, basis);
      const Event event = NextEvent(rates, end);
      const double to_radius = LengthToRadius(rates.d);
      if (std::isinf(to_radius) && std::isinf(event.length)) return PathEnd::kParameter;
      const bool is_at_radius = to_radius <= event.length;
      Advance(is_at_radius ? to_radius : event.length, rates);
      if (is_at_radius) return PathEnd::kRadius;
      if (event.added >= 0) {
        if (!Add(event.added, basis)) return PathEnd::kBlocked;
      } else if (event.dropped >= 0) {
        Drop(event.dropped);
      } else {
        return PathEnd::kParameter;
      }
    }
    return PathEnd::kBlocked;
  }

 private:
  // Derivatives with respect to τ while the active rows remain the same.
  struct Rates {
    VectorXd d;
    VectorXd multipliers;
  };

  // The end of such a piece of the path: the change of τ up to it, and the row that becomes active
  // or the position among the active rows that ceases to be active there, −1 for none.
  struct Event {
    double length = 0;
    int added = -1, dropped = -1;
  };

  // `basis`: that of the normals of the active rows.
  Rates RatesOf(const VectorXd& h, const Basis& basis) const {
    VectorXd row_rates(basis.size()), target_rates(basis.size());
    for (int i = 0; i < basis.size(); ++i) {
      row_rates[i] = rows_[active_[i]].rate;
      target_rates[i] = row_rates[i] + OrderedDot(rows_[active_[i]].normal, h);
    }
    VectorXd along = -basis.WithoutNormals(h);
    if (OrderedNorm(along) <= 1e-12 * OrderedNorm(h)) along.setZero();
    const VectorXd lift = basis.SolveLower(row_rates);
    for (int i = 0; i < basis.size(); ++i) along += lift[i] * basis.q[i];
    return {along, basis.SolveUpper(basis.SolveLower(target_rates))};
  }

  // The first change of the active rows, or the end of the path where there is none before it.
  Event NextEvent(const Rates& rates, double end) const {
    Event next{end - parameter_};
    for (int i = 0; i < static_cast<int>(active_.size()); ++i) {
      if (rates.multipliers[i] >= 0) continue;
      const double at = std::max(0.0, -multipliers_[i] / rates.multipliers[i]);
      if (at < next.length) next = {.length = at, .dropped = i};
    }
    const double speed = OrderedNorm(rates.d);
    for (int j = 0; j < static_cast<int>(rows_.size()); ++j) {
      if (std::find(active_.begin(), active_.end(), j) != active_.end()) continue;
      const Row& row = rows_[j];
      const double closing = OrderedDot(row.normal, rates.d) - row.rate;
      if (closing >= -1e-12 * (speed + std::abs(row.rate))) continue;
      const double slack = OrderedDot(row.normal, d_) - row.bound - row.rate * parameter_;
      const double at = std::max(0.0, slack) / -closing;
      if (at < next.length) next = {.length = at, .added = j};
    }
    return next;
  }

  void Advance(double length, const Rates& rates) {
    d_ += length * rates.d;
    parameter_ += length;
    for (size_t i = 0; i < active_.size(); ++i) {
      const Eigen::Index at = static_cast<Eigen::Index>(i);
      multipliers_[i] = std::max(0.0, multipliers_[i] + length * rates.multipliers[at]);
    }
  }

  double LengthToRadius(const VectorXd& along) const {
    const double speed2 = OrderedDot(along, along);
    if (speed2 == 0) return std::numeric_limits<double>::infinity();
    const double room = std::max(0.0, radius_ * radius_ - OrderedDot(d_, d_));
    const double outward = OrderedDot(d_, along);
    const double root = std::sqrt(outward * outward + speed2 * room);
    return outward > 0 ? room / (outward + root) : (root - outward) / speed2;
  }

  void Drop(int position) {
    active_.erase(active_.begin() + position);
    multipliers_.erase(multipliers_.begin() + position);
  }

  // Makes row j active. Returns false if it contradicts the active rows.
  bool Add(int j, const Basis& basis) {
    double multiplier = 0;
    if (OrderedNorm(basis.WithoutNormals(rows_[j].normal)) < 1e-9) {
      const VectorXd y = basis.Coordinates(rows_[j].normal);
      int leaving = -1;
      for (int i = 0; i < basis.size(); ++i) {
        if (y[i] <= 1e-12) continue;
        if (leaving < 0 || multipliers_[i] / y[i] < multiplier) {
          leaving = i;
          multiplier = multipliers_[i] / y[i];
        }
      }
      if (leaving < 0) return false;
      for (int i = 0; i < basis.size(); ++i) {
        multipliers_[i] = std::max(0.0, multipliers_[i] - multiplier * y[i]);
      }
      Drop(leaving);
    }
    active_.push_back(j);
    multipliers_.push_back(multiplier);
    return true;
  }

  double radius_;
  VectorXd d_;
  double parameter_ = 0;
  std::vector<Row> rows_;
  std::vector<int> active_;
  std::vector<double> multipliers_;
};

}  // namespace

TrustRegionStep SolveTrustRegion(const LinearInterpolant& model, const VectorXd& lower,
                                 const VectorXd& upper, double radius) {
  const int n = static_cast<int>(model.gradient.size());
  const int m = static_cast<int>(model.constraints.size());
  double violation = 0, attainable = 0;
  for (int i = 0; i < m; ++i) violation = std::max(violation, -model.constraints[i]);

  Path path(n, radius);
  for (int i = 0; i < m; ++i) {
    const VectorXd normal = model.jacobian.row(i);
    const double length = OrderedNorm(normal);
    const double constraint = model.constraints[i];
    if (length == 0 || length * radius <= 1e-15 * std::abs(constraint)) {
      attainable = std::max(attainable, -constraint);  // no step within the radius can change it
      continue;
    }
    path.rows().push_back({normal / length, (-constraint - violation) / length, 1 / length});
  }
  for (int i = 0; i < n; ++i) {
    if (std::isfinite(lower[i])) path.rows().push_back({VectorXd::Unit(n, i), lower[i], 0});
    if (std::isfinite(upper[i])) path.rows().push_back({-VectorXd::Unit(n, i), -upper[i], 0});
  }

  PathEnd end = PathEnd::kParameter;
  if (violation > attainable) end = path.Follow(VectorXd::Zero(n), violation - attainable);
  const double slope = OrderedNorm(model.gradient);
  if (end != PathEnd::kRadius && slope > 0) {
    path.Freeze();
    end = path.Follow(model.gradient / slope, std::numeric_limits<double>::infinity());
  }
  TrustRegionStep result;
  result.step = path.d();
  result.on_boundary = end == PathEnd::kRadius;
  return result;
}

}  // namespace lacuna
