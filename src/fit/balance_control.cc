#include "fit/balance_control.h"

#include <utility>
#include <vector>

#include "fit/force_response.h"

namespace lacuna {
namespace {

class ForceControl : public BalanceControl {
 public:
  ForceControl(const Model& model, const ForceModel& force_model)
      : BalanceControl(HeldComponents(HeldAxes(model))), force_model_(force_model) {}

  Eigen::VectorXd Unknowns(const Eigen::VectorXd& /*position*/,
                           const Eigen::VectorXd& coefficients) const override {
    return coefficients;
  }

  Eigen::VectorXd Force(const Eigen::VectorXd& unknowns) const override {
    return force_model_.basis * unknowns;
  }

  void Place(const Eigen::VectorXd& /*unknowns*/, Eigen::VectorXd* /*position*/) const override {}

  Eigen::VectorXd Coefficients(const Eigen::VectorXd& unknowns,
                               const Eigen::VectorXd& /*position*/) const override {
    return unknowns;
  }

  BalanceDerivative Differentiate(const BlockMatrix& tangent, LinearSolver* solver) const override {
    ForceResponse response = RespondToForces(tangent, force_model_, solver);
    const Eigen::Index count = force_model_.CoefficientCount();
    return {std::move(response.sensitivity), Eigen::MatrixXd::Identity(count, count),
            response.IsUsable()};
  }

 private:
  const ForceModel& force_model_;
};

// A component that carries one coefficient, and the force of this coefficient's unit.
struct LoadedComponent {
  Eigen::Index component = 0;  // 3 node + axis
  double force = 0;            // N
};

// One per coefficient, in their order; empty where ControlPlaces does not apply.
std::vector<LoadedComponent> LoadedComponents(const ForceModel& force_model,
                                              const std::vector<AxisSet>& held) {
  const Eigen::Index count = force_model.CoefficientCount();
  if (count == 0 || force_model.basis.nonZeros() != count) return {};
  std::vector<LoadedComponent> loaded(static_cast<size_t>(count));
  for (Eigen::Index row = 0; row < force_model.basis.rows(); ++row) {
    Eigen::Index in_row = 0;
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator entry(force_model.basis, row);
         entry; ++entry) {
      LoadedComponent& of_column = loaded[static_cast<size_t>(entry.col())];
      const bool is_held = held[static_cast<size_t>(row / 3)].Has(static_cast<int>(row % 3));
      if (++in_row > 1 || entry.value() == 0 || of_column.force != 0 || is_held) return {};
      of_column = {row, entry.value()};
    }
  }
  return loaded;
}

std::vector<AxisSet> WithLoaded(std::vector<AxisSet> held,
                                const std::vector<LoadedComponent>& loaded) {
  for (const LoadedComponent& at : loaded) {
    AxisSet& of_node = held[static_cast<size_t>(at.component / 3)];
    of_node = of_node | AxisSet::Of(static_cast<int>(at.component % 3));
  }
  return held;
}

class PlaceControl : public BalanceControl {
 public:
  PlaceControl(const Model& model, const StepEquation& equation,
               std::vector<LoadedComponent> loaded)
      : BalanceControl(HeldComponents(WithLoaded(HeldAxes(model), loaded))),
        model_(model),
        equation_(equation),
        loaded_(std::move(loaded)) {}

  Eigen::VectorXd Unknowns(const Eigen::VectorXd& position,
                           const Eigen::VectorXd& /*coefficients*/) const override {
    Eigen::VectorXd places(Count());
    for (Eigen::Index k = 0; k < Count(); ++k) places[k] = position[At(k).component];
    return places;
  }

  Eigen::VectorXd Force(const Eigen::VectorXd& /*unknowns*/) const override {
    return Eigen::VectorXd::Zero(3 * model_.body->NodeCount());
  }

  void Place(const Eigen::VectorXd& unknowns, Eigen::VectorXd* position) const override {
    for (Eigen::Index k = 0; k < Count(); ++k) (*position)[At(k).component] = unknowns[k];
  }

  Eigen::VectorXd Coefficients(const Eigen::VectorXd& /*unknowns*/,
                               const Eigen::VectorXd& position) const override {
    Eigen::VectorXd residual;
    equation_.Residual(position, &residual);
    return Reactions(residual);
  }

  // With the free components f and the loaded ones l, K_ff ∂x_f/∂u = −K_fl, and the reactions
  // change by the loaded rows of K ∂x/∂u.
  BalanceDerivative Differentiate(const BlockMatrix& tangent, LinearSolver* solver) const override {
    const Eigen::Index size = 3 * model_.body->NodeCount();
    BalanceDerivative derivative;
    derivative.position.resize(size, Count());
    derivative.coefficients.resize(Count(), Count());
    for (Eigen::Index k = 0; k < Count(); ++k) {
      Eigen::VectorXd motion = Eigen::VectorXd::Unit(size, At(k).component);
      Eigen::VectorXd force, others;
      tangent.Multiply(motion, &force);
      force *= -1;
      held().ClearIn(force);
      if (!solver->Solve(tangent, force, &others).IsUsable()) return derivative;
      motion += others;
      derivative.position.col(k) = motion;
      tangent.Multiply(motion, &force);
      derivative.coefficients.col(k) = Reactions(force);
    }
    derivative.is_usable = true;
    return derivative;
  }

 private:
  Eigen::Index Count() const { return static_cast<Eigen::Index>(loaded_.size()); }
  const LoadedComponent& At(Eigen::Index k) const { return loaded_[static_cast<size_t>(k)]; }

  // Nodal forces (3n, N) as coefficients.
  Eigen::VectorXd Reactions(const Eigen::VectorXd& force) const {
    Eigen::VectorXd coefficients(Count());
    for (Eigen::Index k = 0; k < Count(); ++k)
      coefficients[k] = force[At(k).component] / At(k).force;
    return coefficients;
  }

  const Model& model_;
  const StepEquation& equation_;
  std::vector<LoadedComponent> loaded_;
};

}  // namespace

std::unique_ptr<BalanceControl> ControlForces(const Model& model, const ForceModel& force_model) {
  return std::make_unique<ForceControl>(model, force_model);
}

std::unique_ptr<BalanceControl> ControlPlaces(const Model& model, const StepEquation& equation,
                                              const ForceModel& force_model) {
  std::vector<LoadedComponent> loaded = LoadedComponents(force_model, HeldAxes(model));
  if (loaded.empty()) return nullptr;
  return std::make_unique<PlaceControl>(model, equation, std::move(loaded));
}

}  // namespace lacuna
