// Whether a hypothesis leaves what noise leaves: up to three statistics of its residual, each
// compared with its distribution if the hypothesis is right.
//
// The statistics are, where the space has an unknown smooth force, the log Bayes factor of that
// force beside the hypothesis, the largest evidence (NamedEvidence) of any further effect or
// nuisance beside it, and, where the noise is known, the variance of the residual. With noise, and
// with amounts of its columns from their priors, t' is normal with the covariance v S
// (projected_hypotheses.h), so that the distributions are simulated from the products of the
// recording itself: they need no table of thresholds, and hold whatever the columns are. The
// smallest of their tail probabilities is compared with its own distribution, which makes the
// combined test exact (Tippett's method with simulated dependence; Westfall & Young, Resampling-
// Based Multiple Testing, 1993).
#ifndef LACUNA_DIAGNOSIS_ADEQUACY_H_
#define LACUNA_DIAGNOSIS_ADEQUACY_H_

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "diagnosis/hypothesis_space.h"
#include "diagnosis/projected_hypotheses.h"

namespace lacuna {

// The log Bayes factors of the effects and nuisances of a space, each with its variants summed and
// divided by the number of its rivals.
struct NamedEvidence {
  HypothesisKind kind = HypothesisKind::kEffect;
  std::string name;
  double evidence = 0;
  size_t best = 0;  // index of the variant with the most evidence
};
// One entry per name, in the order in which the names first appear. `factors`: one per hypothesis.
// Effects share one prior probability, and so do nuisances; variants share that of their effect.
std::vector<NamedEvidence> SumVariants(const HypothesisSpace& space,
                                       const Eigen::VectorXd& factors);

struct AdequacyStatistics {
  double unknown_force = 0;    // log Bayes factor; 0 where the space has no unknown force
  double further = 0;          // the largest NamedEvidence::evidence
  double variance = 0;         // of the whitened residual, per degree of freedom
  NamedEvidence best_further;  // what `further` belongs to
};

// The statistics of one residual beside the columns that `projected` has taken. `left`: its
// products as ProjectAll() gives them.
AdequacyStatistics MeasureAdequacy(const ProjectedHypotheses& projected,
                                   const ResidualProducts& left);

struct AdequacyTest {
  static constexpr double kNoStatistic = std::numeric_limits<double>::quiet_NaN();

  AdequacyStatistics found;
  // Tail probabilities under the hypothesis: of each statistic, and of their smallest. NaN for a
  // statistic that there is not, which is no part of the test: that of an unknown force where the
  // space has none, and that of the variance where the noise is not known.
  double p_unknown_force = kNoStatistic, p_further = 1, p_variance = kNoStatistic, p = 1;

  // HypothesisSpace::model_error, which may imitate something that is left.
  double model_error = 0;
  // Twice the larger log evidence of an unknown force and of a further effect or nuisance: the
  // misfit, in units of v, that it removes beyond the price of its flexibility. At least the excess
  // of the misfit over that of the noise where IsResidualRarest().
  double left = 0;

  // The size of the residual is the rarest of the statistics.
  bool IsResidualRarest() const {
    return p_variance < p_further && !(p_variance >= p_unknown_force);
  }
  // Something that may be left is more probable than noise and model error: an unknown force or a
  // further effect has more evidence than `model_error`, or the residual itself is the rarest
  // of the statistics. Otherwise a small p says only that the hypotheses do not describe the noise
  // perfectly.
  bool IsSupported() const {
    return std::max(found.unknown_force, found.further) > model_error || IsResidualRarest();
  }
};

// `further`: columns of the space that belong to the hypothesis, beside the base. `noise_is_known`:
// the standard deviation of the noise was given, so that the variance, relative to that noise, is a
// test. The random draws depend on `seed` alone.
AdequacyTest TestAdequacy(const HypothesisSpace& space, const std::vector<int>& further,
                          bool noise_is_known, uint64_t seed);

// Draws of the products of noise alone: t ~ N(0, v AᵀA), with rᵀr from the same noise. The draws of
// ProjectedHypotheses::Marginal() are the projected products of residuals of which the taken
// columns are true, with amounts drawn from their priors. The unknown part of the model error
// (HypothesisSpace::model_error) is added in a random direction, with its length beside the taken
// columns: in every other draw along the influence of a smooth force, which an error of the
// stiffness resembles, else along that of an effect.
class NoiseDraws {
 public:
  // A space with a model error must have an empty base (CHECKed), because the length of the error
  // is what its base leaves of it.
  explicit NoiseDraws(const HypothesisSpace& space);
  ResidualProducts Draw(uint64_t seed, uint64_t number) const;

 private:
  double variance_;
  Eigen::Index rows_;
  Eigen::MatrixXd root_;                            // AᵀA = root rootᵀ, columns × rank
  double error_ = 0;                                // length of the model error
  Eigen::MatrixXd products_;                        // AᵀA; empty where there is no such error
  std::vector<std::vector<int>> forces_, effects_;  // columns of hypotheses
};

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_ADEQUACY_H_
