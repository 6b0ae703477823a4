#include "diagnosis/adequacy.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "scan/random_bits.h"

namespace lacuna {
namespace {

// Simulated residuals of a test. More: a finer tail probability; 400 give 0.02 to within 0.007.
constexpr int kDraws = 400;
// Eigenvalues of AᵀA, scaled to a unit diagonal, below this share are rounding.
constexpr double kRounding = 1e-12;

// The share of draws with at least this value, the value itself counted as one more draw.
double TailProbability(const std::vector<double>& sorted, double value) {
  const auto first = std::lower_bound(sorted.begin(), sorted.end(), value);
  return static_cast<double>(sorted.end() - first + 1) / static_cast<double>(sorted.size() + 1);
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
  for (size_t k = 0; k < named.size(); ++k) {
    const double largest = *std::max_element(variants[k].begin(), variants[k].end());
    double sum = 0;
    for (const double factor : variants[k]) sum += std::exp(factor - largest);
    named[k].evidence = largest + std::log(sum / static_cast<double>(variants[k].size())) -
                        std::log(static_cast<double>(rivals[named[k].kind]));
  }
  return named;
}

AdequacyStatistics MeasureAdequacy(const HypothesisSpace& space,
                                   const ProjectedHypotheses& projected,
                                   const ResidualProducts& residual) {
  AdequacyStatistics statistics;
  const Eigen::VectorXd toward = projected.Project(residual.toward);
  const Eigen::VectorXd factors = projected.LogBayesFactors(toward);
  for (size_t h = 0; h < space.hypotheses.size(); ++h)
    if (space.hypotheses[h].kind == HypothesisKind::kUnknownForce)
      statistics.unknown_force = factors[static_cast<Eigen::Index>(h)];
  statistics.left = projected.ForceMisfit(toward);
  statistics.further = -std::numeric_limits<double>::infinity();
  for (const NamedEvidence& named : SumVariants(space, factors)) {
    if (named.evidence <= statistics.further) continue;
    statistics.further = named.evidence;
    statistics.best_further = named;
  }
  const double freedom = static_cast<double>(
      std::max<Eigen::Index>(1, space.rows - static_cast<Eigen::Index>(space.base.size())));
  statistics.variance = projected.Misfit(residual) / freedom;
  statistics.left = std::max(statistics.left, 2 * statistics.further);
  return statistics;
}

AdequacyTest TestAdequacy(const HypothesisSpace& space, const std::vector<int>& further,
                          bool noise_is_known, uint64_t seed) {
  const ProjectedHypotheses projected(space, further);
  AdequacyTest test;
  test.model_error = space.model_error;
  test.found = MeasureAdequacy(space, projected, {space.model.squares(), space.model.toward()});
  const NoiseDraws noise(space);
  std::vector<double> drawn[3];
  std::vector<AdequacyStatistics> draws;
  for (int k = 0; k < kDraws; ++k) {
    const AdequacyStatistics& draw = draws.emplace_back(
        MeasureAdequacy(space, projected, noise.Draw(seed, static_cast<uint64_t>(k))));
    drawn[0].push_back(draw.unknown_force);
    drawn[1].push_back(draw.further);
    // The rows are whitened with the given noise, whose variance is then 1.
    drawn[2].push_back(draw.variance / space.variance);
  }
  for (std::vector<double>& values : drawn) std::sort(values.begin(), values.end());
  const auto smallest = [&](const AdequacyStatistics& of, double variance, AdequacyTest* tails) {
    const double p[] = {TailProbability(drawn[0], of.unknown_force),
                        TailProbability(drawn[1], of.further),
                        noise_is_known ? TailProbability(drawn[2], variance) : 1.0};
    if (tails != nullptr) {
      tails->p_unknown_force = p[0];
      tails->p_further = p[1];
      tails->p_variance = p[2];
    }
    return *std::min_element(std::begin(p), std::end(p));
  };
  const double found = smallest(test.found, test.found.variance, &test);
  int as_small = 1;
  for (const AdequacyStatistics& draw : draws)
    as_small += smallest(draw, draw.variance / space.variance, nullptr) <= found;
  test.p = static_cast<double>(as_small) / (kDraws + 1);
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
  const double least = kRounding * eigen.eigenvalues().tail<1>()[0];
  const Eigen::Index rank = (eigen.eigenvalues().array() > least).count();
  root_ = unit.asDiagonal() * eigen.eigenvectors().rightCols(rank) *
          eigen.eigenvalues().tail(rank).cwiseSqrt().asDiagonal();
  if (!(space.model_error > 0)) return;
  error_ = std::sqrt(2 * space.model_error * space.variance);
  products_ = products;
  for (const WeighedHypothesis& hypothesis : space.hypotheses) {
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
  // The product of noise and model error is neglected: its mean is 0.
  products.squares = variance_ * (normal.squaredNorm() + std::max(0.0, rest)) + error_ * error_;
  products.toward = std::sqrt(variance_) * (root_ * normal);
  const bool along_force = effects_.empty() || (number % 2 == 0 && !forces_.empty());
  const auto& along = along_force ? forces_ : effects_;
  if (error_ > 0 && !along.empty()) {
    const std::vector<int>& own = along[RandomBits({seed, number, 3}) % along.size()];
    const Eigen::VectorXd amounts =
        NormalVector(static_cast<Eigen::Index>(own.size()), seed, number, 2);
    const double length = std::sqrt(amounts.dot(products_(own, own) * amounts));
    if (length > 0) products.toward += error_ / length * (products_(Eigen::all, own) * amounts);
  }
  return products;
}

}  // namespace lacuna
