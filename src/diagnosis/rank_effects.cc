#include "diagnosis/rank_effects.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "diagnosis/hypothesis_score.h"
#include "diagnosis/recording_agreement.h"
#include "diagnosis/refit_reach.h"
#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

// The score of a nuisance, as in ScoredNuisance.
struct NuisanceScore {
  double evidence = 0, explained = 0;
  bool adopted = false;
  double uncertain_evidence = 0;
};

// Scores the effects and nuisances of one set of columns, which must outlive it.
class HypothesisScorer {
 public:
  explicit HypothesisScorer(const HypothesisColumns& all);

  // Scores everything, adopts the nuisances that are certain, `most` at most, and scores the rest
  // beside them.
  void ScoreAndAdopt(int most);

  AdoptedNuisances Adopted() const;
  std::vector<ScoredEffect> Effects() const;  // the most evidence first
  const std::vector<ScoredEffect>& WithoutAdopted() const { return without_adopted_; }
  const std::vector<NuisanceScore>& Nuisances() const { return nuisances_; }
  // In the order of the effects, then the nuisances.
  std::vector<TriedVariant> Tried() const;

 private:
  // One effect.
  struct Entry {
    std::vector<size_t> variants = {};  // indices of candidates
    size_t best = 0;                    // index of the best of them
  };

  void ScoreNuisancesOfEveryModel();
  void ScoreEffects(const LinearFit& before);
  // Returns the index of the best nuisance outside the model; −1: there is none.
  int ScoreNuisances(const LinearFit& before);
  double BestEvidence() const;  // of an effect; 0 if none has evidence
  bool IsBetterThanNeighbours(size_t candidate) const;
  ScoredVariant Variant(size_t candidate) const;
  double EffectPenalty(const Entry& entry) const {
    return SelectionPenalty(entry.variants.size()) + SelectionPenalty(entries_.size());
  }

  const HypothesisColumns& all_;
  const WeighedColumns weighed_;
  // The columns of everything in the model: those of HypothesisColumns::base, then the adopted
  // ones.
  std::vector<int> base_;
  std::vector<NuisanceScore> nuisances_;  // of HypothesisColumns::nuisances
  std::vector<Score> scores_;             // of HypothesisColumns::candidates
  std::vector<Entry> entries_;            // the best first
  std::vector<ScoredEffect> without_adopted_;
};

HypothesisScorer::HypothesisScorer(const HypothesisColumns& all)
    : all_(all),
      weighed_(WeighColumns(all.misfit, all.columns, all.priors, all.noise.correlation_time)),
      base_(all.base) {
  for (const NuisanceCandidate& nuisance : all.nuisances)
    nuisances_.push_back({.adopted = nuisance.card.is_always_in_model});
  ScoreNuisancesOfEveryModel();
}

void HypothesisScorer::ScoreAndAdopt(int most) {
  for (int adopted = 0;; ++adopted) {
    const LinearFit before = weighed_.all.Fit(base_, all_.noise.variance);
    ScoreEffects(before);
    const int best = ScoreNuisances(before);
    const double rival = BestEvidence();
    if (best < 0 || adopted == most) break;
    NuisanceScore& nuisance = nuisances_[static_cast<size_t>(best)];
    if (nuisance.evidence < rival + kThresholds.ranking.nuisance_lead) break;
    if (adopted == 0) without_adopted_ = Effects();
    nuisance.adopted = true;
    base_ = Joined(base_, all_.of_nuisance[static_cast<size_t>(best)]);
  }
}

// Each by itself, beside the parameters alone.
void HypothesisScorer::ScoreNuisancesOfEveryModel() {
  const double variance = all_.noise.variance;
  const LinearFit without = weighed_.all.Fit(all_.parameters, variance);
  for (size_t k = 0; k < nuisances_.size(); ++k) {
    NuisanceScore& nuisance = nuisances_[k];
    if (!nuisance.adopted) continue;
    const LinearFit with = weighed_.all.Fit(Joined(all_.parameters, all_.of_nuisance[k]), variance);
    nuisance.evidence = with.log_evidence - without.log_evidence;
    nuisance.explained = std::clamp(1 - with.misfit / without.misfit, 0.0, 1.0);
    if (all_.nuisances[k].unknown.cols() == 0) continue;
    const LinearGaussianModel unknown =
        weighed_.all.WithResidual(WhitenedRows(all_.nuisances[k].unknown, all_.misfit,
                                               {.correlation_time = all_.noise.correlation_time}),
                                  weighed_.columns);
    nuisance.uncertain_evidence = 0.5 * unknown.Fit(all_.parameters, variance).misfit / variance;
  }
}

void HypothesisScorer::ScoreEffects(const LinearFit& before) {
  scores_.clear();
  entries_.clear();
  for (size_t c = 0; c < all_.candidates.size(); ++c) {
    scores_.push_back(
        ScoreOf(weighed_, base_, before, all_.of_candidate[c], all_.noise.variance, all_.misfit));
    auto same = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
      return all_.candidates[entry.best].type == all_.candidates[c].type;
    });
    if (same == entries_.end()) same = entries_.insert(entries_.end(), Entry{.best = c});
    same->variants.push_back(c);
    if (scores_[c].evidence > scores_[same->best].evidence) same->best = c;
  }
  for (const Entry& entry : entries_)
    for (const size_t c : entry.variants) scores_[c].evidence -= EffectPenalty(entry);
  std::stable_sort(entries_.begin(), entries_.end(), [&](const Entry& a, const Entry& b) {
    return scores_[a.best].evidence > scores_[b.best].evidence;
  });
}

int HypothesisScorer::ScoreNuisances(const LinearFit& before) {
  int best = -1;
  for (size_t k = 0; k < nuisances_.size(); ++k) {
    NuisanceScore& nuisance = nuisances_[k];
    if (nuisance.adopted) continue;
    const LinearFit with =
        weighed_.all.Fit(Joined(base_, all_.of_nuisance[k]), all_.noise.variance);
    nuisance.evidence = with.log_evidence - before.log_evidence -
                        all_.nuisances[k].selection_penalty - SelectionPenalty(nuisances_.size());
    nuisance.explained = std::clamp(1 - with.misfit / before.misfit, 0.0, 1.0);
    if (best < 0 || nuisance.evidence > nuisances_[static_cast<size_t>(best)].evidence)
      best = static_cast<int>(k);
  }
  return best;
}

double HypothesisScorer::BestEvidence() const {
  return entries_.empty() ? 0 : std::max(0.0, scores_[entries_[0].best].evidence);
}

bool HypothesisScorer::IsBetterThanNeighbours(size_t candidate) const {
  const CandidateEffect& own = all_.candidates[candidate];
  if (own.position.IsSingle()) return false;
  for (size_t other = 0; other < all_.candidates.size(); ++other)
    if (other != candidate && all_.candidates[other].type == own.type &&
        AreNeighbours(own.position, all_.candidates[other].position) &&
        scores_[other].evidence >= scores_[candidate].evidence)
      return false;
  return true;
}

ScoredVariant HypothesisScorer::Variant(size_t candidate) const {
  const LinearFit fit =
      weighed_.fitted.Fit(Joined(base_, all_.of_candidate[candidate]), all_.noise.variance);
  return {all_.candidates[candidate], scores_[candidate],
          all_.values + fit.change.head(all_.values.size()),
          -std::log(ReachableShare(all_.candidates[candidate], all_.candidates))};
}

// Other variants from which a refit may start. A support alone has several on each side of the
// body.
constexpr size_t kMostElsewhere = 4;

std::vector<ScoredEffect> HypothesisScorer::Effects() const {
  std::vector<ScoredEffect> effects;
  for (const Entry& entry : entries_) {
    ScoredEffect& scored = effects.emplace_back();
    static_cast<ScoredVariant&>(scored) = Variant(entry.best);
    for (const CandidateAmount& amount : AmountsOf(scored.candidate)) {
      scored.parameters.push_back(amount.name);
      scored.units.push_back(amount.unit);
    }
    for (const Entry& other : entries_)
      if (&other != &entry &&
          weighed_.all.Collinearity(base_, all_.of_candidate[entry.best],
                                    all_.of_candidate[other.best], all_.noise.variance) >
              kThresholds.ranking.look_alike_correlation)
        scored.look_alikes.push_back(all_.candidates[other.best].type);
    for (const size_t c : entry.variants)
      if (c != entry.best && IsBetterThanNeighbours(c)) scored.elsewhere.push_back(Variant(c));
    std::stable_sort(scored.elsewhere.begin(), scored.elsewhere.end(),
                     [](const ScoredVariant& a, const ScoredVariant& b) {
                       return a.score.evidence > b.score.evidence;
                     });
    if (scored.elsewhere.size() > kMostElsewhere) scored.elsewhere.resize(kMostElsewhere);
  }
  return effects;
}

AdoptedNuisances HypothesisScorer::Adopted() const {
  const std::vector<int> adopted(
      base_.begin() + static_cast<std::ptrdiff_t>(all_.parameters.size()), base_.end());
  return {all_.ColumnsOf(adopted), all_.PriorsOf(adopted),
          static_cast<Eigen::Index>(all_.always.size())};
}

std::vector<TriedVariant> HypothesisScorer::Tried() const {
  std::vector<TriedVariant> tried;
  for (const Entry& entry : entries_)
    for (const size_t c : entry.variants) {
      const std::vector<int>& own = all_.of_candidate[c];
      tried.push_back({all_.candidates[c].type, all_.candidates[c].variant, all_.ColumnsOf(own),
                       all_.PriorsOf(own), 0, false, false});
    }
  for (size_t k = 0; k < nuisances_.size(); ++k) {
    const NuisanceCandidate& candidate = all_.nuisances[k];
    if (!candidate.card.is_always_in_model)
      tried.push_back({candidate.card.name, "", candidate.columns, candidate.priors,
                       candidate.selection_penalty, true, nuisances_[k].adopted});
  }
  return tried;
}

// The nuisances of the model without those that are what recordings are compared for.
AdoptedNuisances SharedByRecordings(const EffectRanking& ranking) {
  AdoptedNuisances shared = ranking.adopted.Always();
  for (const ScoredNuisance& nuisance : ranking.nuisances) {
    const NuisanceCard& card = nuisance.candidate.card;
    if (nuisance.adopted && !card.is_always_in_model && !card.separates_recordings)
      shared = shared.And(nuisance.candidate);
  }
  return shared;
}

}  // namespace

EffectRanking RankEffects(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                          Progress* progress, const std::vector<std::string>& without,
                          const SceneColumns& known, const DecidedBase* decided) {
  HypothesisColumns all = MakeHypothesisColumns(problem, values, progress, without, known, decided);
  HypothesisScorer scorer(all);
  scorer.ScoreAndAdopt(decided != nullptr ? 0 : kThresholds.ranking.most_adopted_nuisances);

  EffectRanking ranking;
  ranking.effects = scorer.Effects();
  ranking.tried = scorer.Tried();
  ranking.without_adopted = scorer.WithoutAdopted();
  ranking.adopted = scorer.Adopted();
  ranking.variants = static_cast<int>(all.candidates.size());
  ranking.noise = all.noise;
  ranking.explained_misfit = all.explained_misfit;
  // What the scorer does not need any more is moved: the columns may be large.
  for (size_t k = 0; k < all.nuisances.size(); ++k) {
    const NuisanceScore& score = scorer.Nuisances()[k];
    ranking.nuisances.push_back({.candidate = std::move(all.nuisances[k]),
                                 .evidence = score.evidence,
                                 .explained = score.explained,
                                 .adopted = score.adopted,
                                 .uncertain_evidence = score.uncertain_evidence});
  }
  ranking.untried = std::move(all.untried);
  ranking.scene = std::move(all.scene);
  ranking.unknown_force = std::move(all.unknown_force);
  ranking.agreement = CompareRecordings(problem, values, all.misfit, SharedByRecordings(ranking),
                                        ranking.noise, ranking.ModelError());
  all.misfit.jacobian.resize(0, 0);
  ranking.misfit = std::move(all.misfit);
  progress->End(fmt::format("{} effects in {} variants", ranking.effects.size(), ranking.variants));
  return ranking;
}

}  // namespace lacuna
