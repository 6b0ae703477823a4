// A hypothesis space of random columns, with a residual of chosen content, for tests of the
// decision.
#ifndef LACUNA_TESTS_DIAGNOSIS_SYNTHETIC_SPACE_H_
#define LACUNA_TESTS_DIAGNOSIS_SYNTHETIC_SPACE_H_

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "core/random_bits.h"
#include "diagnosis/decision_input.h"
#include "diagnosis/hypothesis_space.h"

namespace lacuna {

// Rows are already whitened: the noise has the standard deviation 1. Two base columns, the effects
// "drag" and "mass_damping" (nearly the same influence), "gravity" (another one, three components)
// and "fibres", the nuisance "clock", and an unknown force of ten components.
struct SyntheticSpace {
  static constexpr Eigen::Index kRows = 500;
  static constexpr int kBase = 2;

  explicit SyntheticSpace(double alikeness = 0.3) {
    const auto random = [](uint64_t stream, Eigen::Index columns) {
      Eigen::MatrixXd matrix(kRows, columns);
      for (Eigen::Index k = 0; k < columns; ++k)
        for (Eigen::Index row = 0; row < kRows; ++row)
          matrix(row, k) =
              Normal(RandomBits({stream, static_cast<uint64_t>(k), static_cast<uint64_t>(row)})) /
              std::sqrt(static_cast<double>(kRows));
      return matrix;
    };
    const Eigen::MatrixXd base = random(1, kBase), drag = random(2, 1), other = random(3, 1);
    columns.resize(kRows, kBase);
    columns = base;
    priors.resize(kBase);
    Add(HypothesisKind::kEffect, "drag", drag);
    Add(HypothesisKind::kEffect, "mass_damping", drag + alikeness * other);
    Add(HypothesisKind::kEffect, "gravity", random(4, 3));
    Add(HypothesisKind::kEffect, "fibres", random(5, 1));
    Add(HypothesisKind::kNuisance, "clock", random(6, 1));
    unknown = random(7, 10);
    Add(HypothesisKind::kUnknownForce, "", unknown);
  }

  void Add(HypothesisKind kind, const std::string& name, const Eigen::MatrixXd& own) {
    WeighedHypothesis hypothesis;
    hypothesis.kind = kind;
    hypothesis.name = name;
    for (Eigen::Index k = 0; k < own.cols(); ++k) {
      hypothesis.columns.push_back(static_cast<int>(columns.cols()));
      columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
      columns.rightCols(1) = own.col(k);
      priors.push_back({0, 20, false});
    }
    hypotheses.push_back(hypothesis);
  }

  static Eigen::VectorXd Noise(uint64_t seed) {
    Eigen::VectorXd noise(kRows);
    for (Eigen::Index row = 0; row < kRows; ++row)
      noise[row] = Normal(RandomBits({seed, 99, static_cast<uint64_t>(row)}));
    return noise;
  }

  // The columns of a hypothesis.
  Eigen::MatrixXd Of(const std::string& name) const {
    for (const WeighedHypothesis& hypothesis : hypotheses)
      if (hypothesis.name == name) return columns(Eigen::all, hypothesis.columns);
    return {};
  }

  HypothesisSpace With(const Eigen::VectorXd& residual) const {
    return MakeHypothesisSpace(residual, columns, priors, kBase, hypotheses, 1, kRows);
  }

  Eigen::MatrixXd columns, unknown;
  std::vector<LinearPrior> priors;
  std::vector<WeighedHypothesis> hypotheses;
};

// The input of a decision upon this residual, without refits. The noise is known.
inline DecisionInput InputOf(const SyntheticSpace& synthetic, const Eigen::VectorXd& residual) {
  DecisionInput input;
  input.baseline = synthetic.With(residual);
  input.families = {{"drag", EffectFamily::kLossOutside},
                    {"mass_damping", EffectFamily::kLossOutside},
                    {"gravity", EffectFamily::kSteadyForce},
                    {"fibres", EffectFamily::kStiffnessDistribution}};
  input.noise_is_known = true;
  return input;
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_DIAGNOSIS_SYNTHETIC_SPACE_H_
