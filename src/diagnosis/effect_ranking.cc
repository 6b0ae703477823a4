#include "diagnosis/effect_ranking.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "diagnosis/decision_rules.h"
#include "diagnosis/grip_motions.h"
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/recording_agreement.h"
#include "diagnosis/refit_reach.h"
#include "diagnosis/thresholds.h"
#include "diagnosis/unknown_force.h"

namespace lacuna {
namespace {

std::vector<int> Range(Eigen::Index first, Eigen::Index count) {
  std::vector<int> range(static_cast<size_t>(count));
  std::iota(range.begin(), range.end(), static_cast<int>(first));
  return range;
}

// The columns of all hypotheses.
struct Hypotheses {
  Eigen::MatrixXd columns;
  std::vector<LinearPrior> priors;

  // Appends columns and returns their indices.
  std::vector<int> Add(const Eigen::MatrixXd& more, const std::vector<LinearPrior>& more_priors) {
    const Eigen::Index first = columns.cols();
    if (columns.rows() == 0) columns.resize(more.rows(), 0);
    columns.conservativeResize(Eigen::NoChange, first + more.cols());
    columns.rightCols(more.cols()) = more;
    priors.insert(priors.end(), more_priors.begin(), more_priors.end());
    return Range(first, more.cols());
  }
};

std::vector<LinearPrior> PriorsOf(const CandidateEffect& candidate) {
  std::vector<LinearPrior> priors;
  for (const CandidateAmount& amount : AmountsOf(candidate))
    priors.push_back({0, amount.plausible, amount.is_positive});
  return priors;
}

std::vector<MisfitDirection> DirectionsOf(const std::vector<CandidateEffect>& candidates) {
  std::vector<MisfitDirection> directions;
  for (const CandidateEffect& candidate : candidates)
    for (const int parameter : candidate.amplitude)
      directions.push_back({.perturbation = {.effect = candidate.effect, .parameter = parameter}});
  return directions;
}

// The columns of all hypotheses along one trajectory: the parameters of the model, the effects in
// their variants, the nuisances.
class HypothesisRanking {
 public:
  HypothesisRanking(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                    const std::vector<std::string>& without, const SceneColumns& known,
                    const DecidedBase* decided);

  // Scores everything, adopts the nuisances that are certain, and moves the result out.
  EffectRanking Rank() &&;

 private:
  // One effect.
  struct Entry {
    std::vector<size_t> variants = {};  // indices of candidates_
    size_t best = 0;                    // index of the best of them
  };

  // A nuisance that an earlier ranking has adopted: with its columns along this motion, or along
  // that of the earlier ranking where it cannot be made anew.
  struct DecidedNuisance {
    const NuisanceCandidate* before;
    std::vector<int> columns;

    bool Is(const NuisanceCandidate& candidate) const {
      return before->card.name == candidate.card.name && before->what == candidate.what;
    }
  };

  void AddDecided();
  void AddEffects(const Eigen::MatrixXd& columns, PilotHypotheses pilots);
  void AddNuisance(NuisanceCandidate candidate);
  // Makes the base of the parameters, the nuisances of every model and the decided ones.
  void SetBase();
  // The residual, m, after a fit of these columns to white noise.
  Eigen::VectorXd ResidualAfter(const std::vector<int>& chosen) const;
  void ScoreNuisancesOfEveryModel();
  void ScoreEffectsAndNuisances();
  void ScoreEffects(const LinearFit& before);
  double BestEvidence() const;  // of an effect; 0 if none has evidence
  bool IsBetterThanNeighbours(size_t candidate) const;
  // Returns the index of the best nuisance outside the model; −1: there is none.
  int ScoreNuisances(const LinearFit& before);
  std::vector<ScoredEffect> ScoredEntries() const;
  ScoredVariant Variant(size_t candidate) const;
  std::vector<TriedVariant> Tried() const;
  std::vector<LinearPrior> PriorsOfBase() const {
    std::vector<LinearPrior> priors;
    for (const int column : base_) priors.push_back(hypotheses_.priors[column]);
    return priors;
  }
  double EffectPenalty(const Entry& entry) const {
    return SelectionPenalty(entry.variants.size()) + SelectionPenalty(entries_.size());
  }

  const CalibrationProblem& problem_;
  const Eigen::VectorXd values_;
  const Eigen::Index known_;  // number of the problem's parameters
  const DecidedBase* const decided_;
  std::vector<CandidateEffect> candidates_;
  LinearisedMisfit misfit_;
  Hypotheses hypotheses_;
  // Columns: of the problem's parameters, of the nuisances of every model, of all in the model.
  std::vector<int> parameters_, always_, base_;
  std::vector<DecidedNuisance> decided_nuisances_;
  std::vector<std::vector<int>> of_candidate_, of_nuisance_;  // columns
  EffectRanking ranking_;
  std::optional<WeighedColumns> weighed_;
  std::vector<Score> scores_;   // of candidates_
  std::vector<Entry> entries_;  // the best first
};

HypothesisRanking::HypothesisRanking(const CalibrationProblem& problem,
                                     const Eigen::VectorXd& values,
                                     const std::vector<std::string>& without,
                                     const SceneColumns& known, const DecidedBase* decided)
    : problem_(problem),
      values_(values),
      known_(static_cast<Eigen::Index>(problem.parameters().size())),
      decided_(decided) {
  const PredictionStudy study = problem.StudyAt(values);  // candidates take moduli from its effects
  candidates_ =
      MakeCandidates({*problem.body(), study.effects, study.time_step, Duration(study), without,
                      study.candidates, GrippedNodes(problem.models().front().model())});
  const GripMotions grips = MakeGripMotions(problem);
  std::vector<MisfitDirection> directions = DirectionsOf(candidates_);
  const Eigen::Index of_effects = static_cast<Eigen::Index>(directions.size());
  directions.insert(directions.end(), grips.directions.begin(), grips.directions.end());
  misfit_ = problem.Linearise(values, true, directions);
  CHECK(misfit_.usable) << "the fitted model could be predicted before: " << misfit_.message;

  parameters_ =
      hypotheses_.Add(misfit_.jacobian.leftCols(known_), PriorsAbout(problem.parameters(), values));
  AddDecided();
  ranking_.explained_misfit = study.explained_misfit;
  ranking_.scene.pilots =
      known.pilots ? *known.pilots : RunPilots(problem, values, misfit_, without);
  AddEffects(misfit_.jacobian.middleCols(known_, of_effects), *ranking_.scene.pilots);
  const Eigen::MatrixXd grip_columns =
      misfit_.jacobian.rightCols(misfit_.jacobian.cols() - known_ - of_effects);
  for (NuisanceCandidate& nuisance : ModelNuisances(
           {problem, values, misfit_, grips, grip_columns, known.at_mesh_limit}, known.nuisances)) {
    if (nuisance.card.is_shared_in_scene) ranking_.scene.nuisances.push_back(nuisance);
    AddNuisance(std::move(nuisance));
  }
  if (decided != nullptr) {
    ranking_.noise = decided->noise;
  } else {
    // The noise is what remains when every hypothesis explains as much as it can.
    ranking_.noise = LevelOf(ResidualAfter(Range(0, hypotheses_.columns.cols())), misfit_,
                             hypotheses_.columns.cols(), problem.LeastNoiseVariance());
  }
  for (NuisanceCandidate& nuisance : GripNuisances(grips, grip_columns))
    AddNuisance(std::move(nuisance));
  SetBase();
  const Eigen::VectorXd whitened =
      WhitenedRows(ResidualAfter(base_), misfit_, ranking_.noise.correlation_time, false);
  for (NuisanceCandidate& nuisance : RecordingNuisances(problem, misfit_, whitened))
    AddNuisance(std::move(nuisance));
  SetBase();
  weighed_ = WeighColumns(misfit_, hypotheses_.columns, hypotheses_.priors,
                          ranking_.noise.correlation_time);
  ranking_.unknown_force = UnknownForceColumns(problem, values, misfit_);
}

void HypothesisRanking::AddEffects(const Eigen::MatrixXd& columns, PilotHypotheses pilots) {
  Eigen::Index column = 0;
  for (const CandidateEffect& candidate : candidates_) {
    const Eigen::Index width = static_cast<Eigen::Index>(candidate.amplitude.size());
    of_candidate_.push_back(
        hypotheses_.Add(columns.middleCols(column, width), PriorsOf(candidate)));
    column += width;
  }
  for (PilotHypothesis& pilot : pilots.tried) {
    of_candidate_.push_back(hypotheses_.Add(pilot.change, PriorsOf(pilot.candidate)));
    candidates_.push_back(std::move(pilot.candidate));
  }
  ranking_.untried = std::move(pilots.untried);
}

void HypothesisRanking::AddDecided() {
  if (decided_ == nullptr) return;
  for (const ScoredNuisance& nuisance : decided_->ranking.nuisances) {
    const NuisanceCandidate& before = nuisance.candidate;
    if (nuisance.adopted && !before.card.is_always_in_model)
      decided_nuisances_.push_back({&before, hypotheses_.Add(before.columns, before.priors)});
  }
}

void HypothesisRanking::AddNuisance(NuisanceCandidate candidate) {
  for (DecidedNuisance& decided : decided_nuisances_) {
    if (!decided.Is(candidate)) continue;
    if (candidate.columns.cols() > 0)
      decided.columns = hypotheses_.Add(candidate.columns, candidate.priors);
    return;
  }
  for (const std::string& recording : candidate.left_out)
    ranking_.untried.push_back(
        {candidate.card.name, fmt::format("{} has more than {} frames: thin them out with `every`",
                                          recording, kThresholds.nuisances.most_single_frames)});
  if (candidate.columns.cols() == 0) return;
  const bool adopted = candidate.card.is_always_in_model;
  of_nuisance_.push_back(hypotheses_.Add(candidate.columns, candidate.priors));
  ranking_.nuisances.push_back({.candidate = std::move(candidate), .adopted = adopted});
  if (adopted) always_ = Joined(always_, of_nuisance_.back());
}

void HypothesisRanking::SetBase() {
  base_ = Joined(parameters_, always_);
  for (const DecidedNuisance& decided : decided_nuisances_) base_ = Joined(base_, decided.columns);
}

Eigen::VectorXd HypothesisRanking::ResidualAfter(const std::vector<int>& chosen) const {
  const LinearFit fit =
      LinearGaussianModel(WhitenedRows(misfit_.residual, misfit_, 0, false),
                          WhitenedRows(hypotheses_.columns, misfit_, 0, false), hypotheses_.priors)
          .Fit(chosen, 1);
  return misfit_.residual + hypotheses_.columns(Eigen::all, chosen) * fit.change;
}

void HypothesisRanking::ScoreEffectsAndNuisances() {
  const RankingThresholds& thresholds = kThresholds.ranking;
  const int most = decided_ != nullptr ? 0 : thresholds.most_adopted_nuisances;
  for (int adopted = 0;; ++adopted) {
    const LinearFit before = weighed_->all.Fit(base_, ranking_.noise.variance);
    ScoreEffects(before);
    const int best = ScoreNuisances(before);
    const double rival = BestEvidence();
    if (best < 0 || adopted == most) break;
    ScoredNuisance& nuisance = ranking_.nuisances[static_cast<size_t>(best)];
    if (nuisance.evidence < rival + thresholds.nuisance_lead) break;
    if (adopted == 0) ranking_.without_adopted = ScoredEntries();
    nuisance.adopted = true;
    base_ = Joined(base_, of_nuisance_[static_cast<size_t>(best)]);
  }
}

// Each by itself, beside the parameters alone.
void HypothesisRanking::ScoreNuisancesOfEveryModel() {
  const double variance = ranking_.noise.variance;
  const LinearFit without = weighed_->all.Fit(parameters_, variance);
  for (size_t k = 0; k < ranking_.nuisances.size(); ++k) {
    ScoredNuisance& nuisance = ranking_.nuisances[k];
    if (!nuisance.adopted) continue;
    const LinearFit with = weighed_->all.Fit(Joined(parameters_, of_nuisance_[k]), variance);
    nuisance.evidence = with.log_evidence - without.log_evidence;
    nuisance.explained = std::clamp(1 - with.misfit / without.misfit, 0.0, 1.0);
    if (nuisance.candidate.unknown.cols() == 0) continue;
    const LinearGaussianModel unknown = weighed_->all.WithResidual(
        WhitenedRows(nuisance.candidate.unknown, misfit_, ranking_.noise.correlation_time, false),
        weighed_->columns);
    nuisance.uncertain_evidence = 0.5 * unknown.Fit(parameters_, variance).misfit / variance;
  }
}

void HypothesisRanking::ScoreEffects(const LinearFit& before) {
  scores_.clear();
  entries_.clear();
  for (size_t c = 0; c < candidates_.size(); ++c) {
    scores_.push_back(
        ScoreOf(*weighed_, base_, before, of_candidate_[c], ranking_.noise.variance, misfit_));
    auto same = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
      return candidates_[entry.best].type == candidates_[c].type;
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

double HypothesisRanking::BestEvidence() const {
  return entries_.empty() ? 0 : std::max(0.0, scores_[entries_[0].best].evidence);
}

bool HypothesisRanking::IsBetterThanNeighbours(size_t candidate) const {
  const CandidateEffect& own = candidates_[candidate];
  if (own.position.IsSingle()) return false;
  for (size_t other = 0; other < candidates_.size(); ++other)
    if (other != candidate && candidates_[other].type == own.type &&
        AreNeighbours(own.position, candidates_[other].position) &&
        scores_[other].evidence >= scores_[candidate].evidence)
      return false;
  return true;
}

int HypothesisRanking::ScoreNuisances(const LinearFit& before) {
  int best = -1;
  for (size_t k = 0; k < ranking_.nuisances.size(); ++k) {
    ScoredNuisance& nuisance = ranking_.nuisances[k];
    if (nuisance.adopted) continue;
    const LinearFit with =
        weighed_->all.Fit(Joined(base_, of_nuisance_[k]), ranking_.noise.variance);
    nuisance.evidence = with.log_evidence - before.log_evidence -
                        nuisance.candidate.selection_penalty -
                        SelectionPenalty(ranking_.nuisances.size());
    nuisance.explained = std::clamp(1 - with.misfit / before.misfit, 0.0, 1.0);
    if (best < 0 || nuisance.evidence > ranking_.nuisances[static_cast<size_t>(best)].evidence)
      best = static_cast<int>(k);
  }
  return best;
}

ScoredVariant HypothesisRanking::Variant(size_t candidate) const {
  const LinearFit fit =
      weighed_->fitted.Fit(Joined(base_, of_candidate_[candidate]), ranking_.noise.variance);
  return {candidates_[candidate], scores_[candidate], values_ + fit.change.head(known_),
          -std::log(ReachableShare(candidates_[candidate], candidates_))};
}

// Other variants from which a refit may start. A support alone has several on each side of the
// body.
constexpr size_t kMostElsewhere = 4;

std::vector<ScoredEffect> HypothesisRanking::ScoredEntries() const {
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
          weighed_->all.Collinearity(base_, of_candidate_[entry.best], of_candidate_[other.best],
                                     ranking_.noise.variance) >
              kThresholds.ranking.look_alike_correlation)
        scored.look_alikes.push_back(candidates_[other.best].type);
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

std::vector<TriedVariant> HypothesisRanking::Tried() const {
  std::vector<TriedVariant> tried;
  for (const Entry& entry : entries_)
    for (const size_t c : entry.variants)
      tried.push_back({candidates_[c].type, candidates_[c].variant,
                       hypotheses_.columns(Eigen::all, of_candidate_[c]), PriorsOf(candidates_[c]),
                       0, false, false});
  for (const ScoredNuisance& nuisance : ranking_.nuisances) {
    const NuisanceCandidate& candidate = nuisance.candidate;
    if (!candidate.card.is_always_in_model)
      tried.push_back({candidate.card.name, "", candidate.columns, candidate.priors,
                       candidate.selection_penalty, true, nuisance.adopted});
  }
  return tried;
}

EffectRanking HypothesisRanking::Rank() && {
  ScoreNuisancesOfEveryModel();
  ScoreEffectsAndNuisances();
  ranking_.variants = static_cast<int>(candidates_.size());
  const std::vector<int> adopted(base_.begin() + known_, base_.end());
  ranking_.adopted.columns = hypotheses_.columns(Eigen::all, adopted);
  ranking_.adopted.always = static_cast<Eigen::Index>(always_.size());
  for (const int k : adopted) ranking_.adopted.priors.push_back(hypotheses_.priors[k]);
  ranking_.effects = ScoredEntries();
  ranking_.tried = Tried();
  ranking_.space = SpaceBeside(misfit_, hypotheses_.columns(Eigen::all, base_), PriorsOfBase(),
                               ranking_, {}, ranking_.noise);
  ranking_.agreement =
      CompareRecordings(problem_, values_, misfit_, ranking_.adopted, ranking_.noise);
  misfit_.jacobian.resize(0, 0);
  ranking_.misfit = std::move(misfit_);
  return std::move(ranking_);
}

}  // namespace

HypothesisSpace SpaceBeside(const LinearisedMisfit& misfit, const Eigen::MatrixXd& base,
                            std::vector<LinearPrior> priors, const EffectRanking& ranking,
                            const std::vector<std::string>& without, const NoiseLevel& noise,
                            bool base_has_adopted) {
  const auto is_in_base = [&](const TriedVariant& tried) {
    return std::count(without.begin(), without.end(), tried.type) > 0 ||
           (tried.is_adopted && base_has_adopted);
  };
  Eigen::Index width = base.cols() + ranking.unknown_force.cols();
  for (const TriedVariant& tried : ranking.tried)
    if (!is_in_base(tried)) width += tried.columns.cols();
  Eigen::MatrixXd columns(base.rows(), width);
  columns.leftCols(base.cols()) = base;
  Eigen::Index column = base.cols();
  std::vector<WeighedHypothesis> hypotheses;
  const auto add = [&](WeighedHypothesis hypothesis, const Eigen::MatrixXd& own) {
    if (own.cols() == 0) return;
    columns.middleCols(column, own.cols()) = own;
    hypothesis.columns = Range(column, own.cols());
    column += own.cols();
    hypotheses.push_back(std::move(hypothesis));
  };
  for (const TriedVariant& tried : ranking.tried) {
    if (is_in_base(tried)) continue;
    add({tried.is_nuisance ? HypothesisKind::kNuisance : HypothesisKind::kEffect,
         tried.type,
         tried.variant,
         {},
         tried.selection_penalty},
        tried.columns);
    priors.insert(priors.end(), tried.priors.begin(), tried.priors.end());
  }
  WeighedHypothesis unknown;
  unknown.kind = HypothesisKind::kUnknownForce;
  add(std::move(unknown), ranking.unknown_force);
  priors.resize(static_cast<size_t>(width), {0, 1, false});
  HypothesisSpace space = MakeHypothesisSpace(
      WhitenedRows(misfit.residual, misfit, noise.correlation_time, false),
      WhitenedRows(columns, misfit, noise.correlation_time, false), std::move(priors), base.cols(),
      std::move(hypotheses), noise.variance, ObservedRows(misfit));
  space.model_error = ranking.ModelError();
  return space;
}

const ScoredEffect* EffectRanking::Find(const std::string& type) const {
  const auto found = std::find_if(effects.begin(), effects.end(), [&](const ScoredEffect& effect) {
    return effect.candidate.type == type;
  });
  return found != effects.end() ? &*found : nullptr;
}

double EffectRanking::ModelError() const {
  double error = 0.5 * kToleratedModelError * explained_misfit;
  for (const ScoredNuisance& nuisance : nuisances) error += nuisance.uncertain_evidence;
  return error;
}

double SelectionPenalty(size_t rivals) {
  return std::log(static_cast<double>(std::max<size_t>(rivals, 1)));
}

AdoptedNuisances AdoptedNuisances::Always() const {
  return {columns.leftCols(always), {priors.begin(), priors.begin() + always}, always};
}

AdoptedNuisances AdoptedNuisances::And(const NuisanceCandidate& nuisance) const {
  AdoptedNuisances with = *this;
  with.columns.conservativeResize(Eigen::NoChange, columns.cols() + nuisance.columns.cols());
  with.columns.rightCols(nuisance.columns.cols()) = nuisance.columns;
  with.priors.insert(with.priors.end(), nuisance.priors.begin(), nuisance.priors.end());
  return with;
}

EffectRanking RankEffects(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                          Progress* progress, const std::vector<std::string>& without,
                          const SceneColumns& known, const DecidedBase* decided) {
  progress->Begin("score", 0);
  EffectRanking ranking = HypothesisRanking(problem, values, without, known, decided).Rank();
  progress->End(fmt::format("{} effects in {} variants", ranking.effects.size(), ranking.variants));
  return ranking;
}

}  // namespace lacuna
