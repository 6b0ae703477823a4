#include "diagnosis/adequacy.h"

#include <glog/logging.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "analysis/linear_evidence.h"
#include "core/random_bits.h"

namespace lacuna {
namespace {

// Simulated residuals of a test. More: a finer tail probability; 400 give 0.02 to within 0.007.
constexpr int kDraws = 400;
// Eigenvalues of AᵀA, scaled to a unit diagonal, below this share are rounding.
constexpr double kEigenvalueRounding = 1e-12;

// The share of the values, of which `value` is one, that are not smaller.
double TailProbability(const std::vector<double>& sorted, double value) {
  const auto first = std::lower_bound(sorted.begin(), sorted.end(), value);
  return static_cast<double>(sorted.end() - first) / static_cast<double>(sorted.size());
}

bool HasUnknownForce(const HypothesisSpace& space) {
  return std::any_of(space.hypotheses.begin(), space.hypotheses.end(),
                     [](const WeighedHypothesis& hypothesis) {
                       return hypothesis.kind == HypothesisKind::kUnknownForce;
                     });
}

// Independent standard normal numbers.
Eigen::VectorXd NormalVector(Eigen::Index size, uint64_t seed, uint64_t number, uint64_t stream) {
  Eigen::VectorXd normal(size);
  for (Eigen::Index k = 0; k < size; ++k)
    normal[k] = Normal(RandomBits({seed, number, stream, static_cast<uint64_t>(k)}));
  return normal;
}

}  // namespace

std::vector<NamedEvidence> SumVariants(const HypothesisSpace& space,
                                       const Eigen::VectorXd& factors) {
  std::vector<NamedEvidence> named;
  std::vector<std::vector<double>> variants;
  std::map<std::pair<HypothesisKind, std::string>, size_t> index;
  for (size_t h = 0; h < space.hypotheses.size(); ++h) {
    const WeighedHypothesis& hypothesis = space.hypotheses[h];
    if (hypothesis.kind == HypothesisKind::kUnknownForce) continue;
    const auto [at, is_new] = index.try_emplace({hypothesis.kind, hypothesis.name}, named.size());
    if (is_new) {
      named.push_back({hypothesis.kind, hypothesis.name, 0, h});
      variants.emplace_back();
    }
    const double factor = factors[static_cast<Eigen::Index>(h)] - hypothesis.selection_penalty;
    std::vector<double>& same = variants[at->second];
    if (!same.empty() && factor > *std::max_element(same.begin(), same.end()))
      named[at->second].best = h;
    same.push_back(factor);
  }
  std::map<HypothesisKind, int> rivals;
  for (const NamedEvidence& own : named) ++rivals[own.kind];
  for (size_t k = 0; k < named.size(); ++k)
    named[k].evidence =
        LogMeanExp(variants[k]) - std::log(static_cast<double>(rivals[named[k].kind]));
  return named;
}

AdequacyStatistics MeasureAdequacy(const ProjectedHypotheses& projected,
                                   const ResidualProducts& left) {
  AdequacyStatistics statistics;
  const HypothesisSpace& space = projected.space();
  const Eigen::VectorXd factors = projected.LogBayesFactors(left.toward);
  for (size_t h = 0; h < space.hypotheses.size(); ++h)
    if (space.hypotheses[h].kind == HypothesisKind::kUnknownForce)
      statistics.unknown_force = factors[static_cast<Eigen::Index>(h)];
  statistics.further = -std::numeric_limits<double>::infinity();
  for (const NamedEvidence& named : SumVariants(space, factors)) {
    if (named.evidence <= statistics.further) continue;
    statistics.further = named.evidence;
    statistics.best_further = named;
  }
  statistics.variance = left.squares / static_cast<double>(projected.Freedom());
  return statistics;
}

AdequacyTest TestAdequacy(const HypothesisSpace& space, const std::vector<int>& further,
                          bool noise_is_known, uint64_t seed) {
  constexpr double kNone = AdequacyTest::kNoStatistic;
  const ProjectedHypotheses projected(space, further);
  const HypothesisSpace marginal = projected.Marginal();
  const double freedom = static_cast<double>(projected.Freedom());
  AdequacyTest test;
  test.model_error = space.model_error;
  test.found = MeasureAdequacy(projected, {marginal.model.squares(), marginal.model.toward()});
  // The rows are whitened with the given noise, whose variance is then 1.
  if (noise_is_known)
    test.found.variance =
        projected.MisfitOfGivenNoise({space.model.squares(), space.model.toward()}) / freedom;
  const NoiseDraws noise(marginal);
  std::vector<AdequacyStatistics> draws;
  for (int k = 0; k < kDraws; ++k) {
    AdequacyStatistics& draw =
        draws.emplace_back(MeasureAdequacy(projected, noise.Draw(seed, static_cast<uint64_t>(k))));
    draw.variance /= space.variance;
  }
  // What was found counts as one more draw: under the hypothesis all of them are alike.
  std::vector<double> all[3];
  const auto add = [&](const AdequacyStatistics& one) {
    all[0].push_back(one.unknown_force);
    all[1].push_back(one.further);
    all[2].push_back(one.variance);
  };
  add(test.found);
  for (const AdequacyStatistics& draw : draws) add(draw);
  for (std::vector<double>& values : all) std::sort(values.begin(), values.end());
  const bool has_force = HasUnknownForce(space);
  const auto smallest = [&](const AdequacyStatistics& of, AdequacyTest* tails) {
    const double of_force = has_force ? TailProbability(all[0], of.unknown_force) : kNone;
    const double of_further = TailProbability(all[1], of.further);
    const double of_variance = noise_is_known ? TailProbability(all[2], of.variance) : kNone;
    if (tails != nullptr) {
      tails->p_unknown_force = of_force;
      tails->p_further = of_further;
      tails->p_variance = of_variance;
    }
    return std::fmin(of_further, std::fmin(of_force, of_variance));  // of those that are numbers
  };
  const double found = smallest(test.found, &test);
  int as_small = 1;
  for (const AdequacyStatistics& draw : draws) as_small += smallest(draw, nullptr) <= found;
  test.p = static_cast<double>(as_small) / (kDraws + 1);
  test.left = 2 * std::max(test.found.unknown_force, test.found.further);
  if (test.IsResidualRarest())
    test.left = std::max(test.left, (test.found.variance - 1) * freedom / space.variance);
  return test;
}

NoiseDraws::NoiseDraws(const HypothesisSpace& space)
    : variance_(space.variance), rows_(space.rows) {
  const Eigen::MatrixXd& products = space.model.products();
  const Eigen::VectorXd unit =
      products.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt();
  const Eigen::VectorXd inverse = unit.cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      Eigen::MatrixXd(inverse.asDiagonal() * products * inverse.asDiagonal()));
  const double least = kEigenvalueRounding * eigen.eigenvalues().tail<1>()[0];
  const Eigen::Index rank = (eigen.eigenvalues().array() > least).count();
  root_ = unit.asDiagonal() * eigen.eigenvectors().rightCols(rank) *
          eigen.eigenvalues().tail(rank).cwiseSqrt().asDiagonal();
  if (!(space.model_error > 0)) return;
  CHECK(space.base.empty());
  error_ = std::sqrt(2 * space.model_error * space.variance);
  products_ = products;
  const Eigen::VectorXd visible = products.diagonal();
  for (const WeighedHypothesis& hypothesis : space.hypotheses) {
    if ((visible(hypothesis.columns).array() <= 0).all()) continue;
    if (hypothesis.kind == HypothesisKind::kUnknownForce) forces_.push_back(hypothesis.columns);
    if (hypothesis.kind == HypothesisKind::kEffect) effects_.push_back(hypothesis.columns);
  }
}

ResidualProducts NoiseDraws::Draw(uint64_t seed, uint64_t number) const {
  const Eigen::VectorXd normal = NormalVector(root_.cols(), seed, number, 0);
  // The part of the noise that no column sees: χ² with many degrees of freedom, by the cube-root
  // approximation of Wilson & Hilferty (PNAS 17, 1931).
  const double unseen = static_cast<double>(std::max<Eigen::Index>(0, rows_ - root_.cols()));
  double rest = 0;
  if (unseen > 0) {
    const double spread = 2 / (9 * unseen);
    const double deviation = std::sqrt(spread) * NormalVector(1, seed, number, 1)[0];
    rest = unseen * std::pow(1 - spread + deviation, 3);
  }
  ResidualProducts products;
  products.squares = variance_ * (normal.squaredNorm() + std::max(0.0, rest));
  products.toward = std::sqrt(variance_) * (root_ * normal);
  const bool along_force = effects_.empty() || (number % 2 == 0 && !forces_.empty());
  const auto& along = along_force ? forces_ : effects_;
  if (error_ > 0 && !along.empty()) {
    const std::vector<int>& own = along[RandomBits({seed, number, 3}) % along.size()];
    const Eigen::VectorXd amounts =
        NormalVector(static_cast<Eigen::Index>(own.size()), seed, number, 2);
    const double length = std::sqrt(amounts.dot(products_(own, own) * amounts));
    if (length > 0) {
      const Eigen::VectorXd error = error_ / length * amounts;
      products.squares += error_ * error_ + 2 * error.dot(products.toward(own));
      products.toward += products_(Eigen::all, own) * error;
    }
  }
  return products;
}

}  // namespace lacuna
