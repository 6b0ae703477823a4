#include "diagnosis/recording_power.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "core/random_bits.h"
#include "diagnosis/adequacy.h"
#include "diagnosis/decision.h"
#include "diagnosis/decision_rules.h"

namespace lacuna {
namespace {

using Kind = HypothesisProbability::Kind;

// Simulated recordings for each truth, and draws of noise from which the tests of adequacy take
// their distributions. More: finer frequencies; 200 give them to within 0.035.
constexpr int kSimulations = 200;

// The statistics of a test of adequacy under noise, beside one variant.
struct NullOfVariant {
  std::unique_ptr<ProjectedHypotheses> projected;
  // The value that noise exceeds with a third of kAdequacyLevel (Bonferroni), for each statistic.
  double unknown_force = 0, further = 0, variance = 0;
};

// The products of the residual that an effect leaves in a model without it, and noise:
// r = ε − C a.
ResidualProducts WithEffect(const HypothesisSpace& space, const FoundEffect& effect,
                            ResidualProducts noise) {
  if (effect.columns.empty()) return noise;
  const Eigen::MatrixXd& products = space.model.products();
  noise.squares += effect.amounts.dot(products(effect.columns, effect.columns) * effect.amounts) -
                   2 * effect.amounts.dot(noise.toward(effect.columns));
  noise.toward -= products(Eigen::all, effect.columns) * effect.amounts;
  return noise;
}

// Amounts of these columns from their priors.
Eigen::VectorXd PriorAmounts(const HypothesisSpace& space, const std::vector<int>& columns,
                             uint64_t seed, uint64_t number) {
  Eigen::VectorXd amounts = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(columns.size()));
  for (size_t k = 0; k < columns.size(); ++k) {
    const double deviation = space.model.Prior(columns[k]).deviation;
    if (std::isfinite(deviation))
      amounts[static_cast<Eigen::Index>(k)] =
          deviation * Normal(RandomBits({seed, number, static_cast<uint64_t>(columns[k])}));
  }
  return amounts;
}

// All products are those after the base of the decision's input has been integrated out.
class SimulatedDecisions {
 public:
  explicit SimulatedDecisions(const DecisionInput& input)
      : input_(input),
        space_(ProjectedHypotheses(input.baseline).Marginal()),
        beside_nothing_(space_) {
    const NoiseDraws noise(space_);
    for (int k = 0; k < kSimulations; ++k)
      draws_.push_back(noise.Draw(input.seed + 2, static_cast<uint64_t>(k)));
  }

  // A residual in which this effect is missing.
  ResidualProducts Draw(const FoundEffect& effect, int k) const {
    return WithEffect(space_, effect, draws_[static_cast<size_t>(k)]);
  }

  // What the rules say of a residual: names, or none; whether something unknown is left.
  struct Outcome {
    std::vector<std::string> names;
    bool is_unknown_left = false;
  };
  Outcome Decide(const ResidualProducts& residual) {
    const std::vector<NamedEvidence> evidence =
        SumVariants(space_, beside_nothing_.LogBayesFactors(residual.toward));
    std::vector<HypothesisProbability> posterior =
        HypothesesOf(evidence, input_.families, space_.model_error);
    SetPosterior(&posterior);
    const HypothesisProbability& best = posterior.front();
    int variant = -1;
    for (const NamedEvidence& named : evidence)
      if (!best.names.empty() && named.name == best.names.front())
        variant = static_cast<int>(named.best);
    const NullOfVariant& null = NullOf(variant);
    const AdequacyStatistics left =
        MeasureAdequacy(*null.projected, null.projected->ProjectAll(residual));
    Outcome outcome;
    outcome.is_unknown_left =
        left.unknown_force > std::max(space_.model_error, null.unknown_force) ||
        left.further > std::max(space_.model_error, null.further) ||
        (input_.noise_is_known && left.variance / space_.variance > null.variance);
    const Naming naming = NameFrom(posterior);
    outcome.names = naming.names;
    return outcome;
  }

 private:
  // `variant`: a hypothesis of the space; −1: none.
  const NullOfVariant& NullOf(int variant) {
    const auto [at, is_new] = nulls_.try_emplace(variant);
    NullOfVariant& null = at->second;
    if (!is_new) return null;
    FoundEffect own;
    if (variant >= 0) own.columns = space_.hypotheses[static_cast<size_t>(variant)].columns;
    null.projected = std::make_unique<ProjectedHypotheses>(space_, own.columns);
    std::vector<double> drawn[3];
    for (int k = 0; k < kSimulations; ++k) {
      own.amounts = PriorAmounts(space_, own.columns, input_.seed + 3, static_cast<uint64_t>(k));
      const AdequacyStatistics left =
          MeasureAdequacy(*null.projected, null.projected->ProjectAll(Draw(own, k)));
      drawn[0].push_back(left.unknown_force);
      drawn[1].push_back(left.further);
      drawn[2].push_back(left.variance / space_.variance);
    }
    const auto quantile = [](std::vector<double>* values) {
      std::sort(values->begin(), values->end());
      return (*values)[static_cast<size_t>((1 - kAdequacyLevel / 3) * kSimulations)];
    };
    null.unknown_force = quantile(&drawn[0]);
    null.further = quantile(&drawn[1]);
    null.variance = quantile(&drawn[2]);
    return null;
  }

  const DecisionInput& input_;
  const HypothesisSpace space_;
  const ProjectedHypotheses beside_nothing_;
  std::vector<ResidualProducts> draws_;
  std::map<int, NullOfVariant> nulls_;
};

// What the decisions say of residuals in which this effect is missing.
RecordedPower PowerOf(const DecisionInput& input, const FoundEffect& effect,
                      SimulatedDecisions* decisions) {
  const std::string& truth = effect.name;
  RecordedPower power;
  if (!truth.empty()) power.truth = {truth};
  std::map<std::string, int> wrong;
  for (int k = 0; k < kSimulations; ++k) {
    const auto outcome = decisions->Decide(decisions->Draw(effect, k));
    constexpr double kShare = 1.0 / kSimulations;
    if (outcome.is_unknown_left)
      power.unknown += kShare;
    else if (outcome.names.size() > 1 || (outcome.names.empty() && !truth.empty()))
      power.open += kShare;
    else if (outcome.names.empty() || outcome.names.front() == truth)
      power.named += kShare;
    else {
      const std::string& name = outcome.names.front();
      const bool is_member = !truth.empty() &&
                             FamilyOf(input.families, name) != EffectFamily::kOther &&
                             FamilyOf(input.families, name) == FamilyOf(input.families, truth);
      (is_member ? power.wrong_member : power.wrong) += kShare;
      ++wrong[name];
    }
  }
  int most = 0;
  for (const auto& [name, count] : wrong) {
    if (count <= most) continue;
    most = count;
    power.most_wrong = name;
  }
  return power;
}

// Whether `whole` is a pair of effects of which `part` is one: a variant has all its columns.
bool IsPartOf(const HypothesisSpace& space, const FoundEffect& part, const std::string& whole) {
  return std::any_of(
      space.hypotheses.begin(), space.hypotheses.end(), [&](const WeighedHypothesis& variant) {
        return variant.kind == HypothesisKind::kEffect && variant.name == whole &&
               std::all_of(part.columns.begin(), part.columns.end(), [&](int column) {
                 return std::count(variant.columns.begin(), variant.columns.end(), column) > 0;
               });
      });
}

std::vector<FoundEffect> FindAll(const HypothesisSpace& space,
                                 const std::vector<std::string>& effects) {
  std::vector<FoundEffect> found;
  for (const std::string& effect : effects) found.push_back(FindEffect(space, effect));
  return found;
}

}  // namespace

FoundEffect FindEffect(const HypothesisSpace& space, const std::string& effect) {
  const ProjectedHypotheses beside_nothing(space);
  const Eigen::VectorXd projected = beside_nothing.Project(space.model.toward());
  FoundEffect found{.name = effect, .columns = {}, .amounts = {}};
  for (const NamedEvidence& named : SumVariants(space, beside_nothing.LogBayesFactors(projected)))
    if (named.kind == HypothesisKind::kEffect && named.name == effect) {
      found.columns = space.hypotheses[named.best].columns;
      found.amounts = beside_nothing.AmountsOf(named.best, projected).value;
    }
  return found;
}

std::vector<RecordedPower> SimulatePower(const DecisionInput& input,
                                         const std::vector<std::string>& effects) {
  SimulatedDecisions decisions(input);
  std::vector<RecordedPower> power;
  std::vector<FoundEffect> truths = {FoundEffect{}};
  for (FoundEffect& effect : FindAll(input.baseline, effects)) truths.push_back(std::move(effect));
  for (const FoundEffect& effect : truths)
    if (effect.name.empty() || !effect.IsNothing())
      power.push_back(PowerOf(input, effect, &decisions));
  return power;
}

std::optional<RecordedPower> PowerToFind(DecisionInput input, const std::string& effect,
                                         bool is_known) {
  const FoundEffect truth = FindEffect(input.baseline, effect);
  if (truth.IsNothing()) return std::nullopt;
  if (!is_known)
    std::erase_if(input.baseline.hypotheses, [&](const WeighedHypothesis& hypothesis) {
      return hypothesis.kind == HypothesisKind::kEffect && hypothesis.name == effect;
    });
  SimulatedDecisions decisions(input);
  return PowerOf(input, truth, &decisions);
}

std::vector<RecordedSeparation> Separations(const DecisionInput& input,
                                            const std::vector<std::string>& effects) {
  return SeparationsOf(input.baseline, FindAll(input.baseline, effects));
}

std::vector<RecordedSeparation> SeparationsOf(const HypothesisSpace& space,
                                              const std::vector<FoundEffect>& effects) {
  const ProjectedHypotheses beside_nothing(space);
  // The squared distance of the prediction of `found` from the nearest one of another effect.
  const auto distance = [&](const FoundEffect& found, const std::string& other) {
    const Eigen::MatrixXd& visible = beside_nothing.products();
    double least = found.amounts.dot(visible(found.columns, found.columns) * found.amounts);
    const double own = least;
    for (const WeighedHypothesis& hypothesis : space.hypotheses) {
      if (hypothesis.kind != HypothesisKind::kEffect || hypothesis.name != other) continue;
      const Eigen::VectorXd toward = visible(hypothesis.columns, found.columns) * found.amounts;
      const Eigen::MatrixXd square = visible(hypothesis.columns, hypothesis.columns);
      const double explained = toward.dot(square.completeOrthogonalDecomposition().solve(toward));
      least = std::min(least, own - explained);
    }
    return std::max(0.0, least) / space.variance;
  };
  const auto smaller = [&](const FoundEffect& a, const FoundEffect& b) {
    if (IsPartOf(space, a, b.name)) return distance(b, a.name);
    if (IsPartOf(space, b, a.name)) return distance(a, b.name);
    return std::min(distance(a, b.name), distance(b, a.name));
  };
  std::vector<RecordedSeparation> separations;
  for (size_t a = 0; a < effects.size(); ++a)
    for (size_t b = a + 1; b < effects.size(); ++b)
      if (!effects[a].IsNothing() && !effects[b].IsNothing())
        separations.push_back({effects[a].name, effects[b].name, smaller(effects[a], effects[b])});
  return separations;
}

}  // namespace lacuna
