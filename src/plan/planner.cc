#include "plan/planner.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "analysis/linear_evidence.h"
#include "calibration/calibration_problem.h"
#include "calibration/linear_misfit.h"
#include "core/error.h"
#include "core/parallel.h"
#include "diagnosis/adequacy.h"
#include "diagnosis/candidates.h"
#include "diagnosis/decision_rules.h"
#include "diagnosis/grip_motions.h"
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/projected_hypotheses.h"
#include "diagnosis/recording_power.h"
#include "fit/calibration.h"
#include "plan/joined_space.h"
#include "plan/planned_recording.h"
#include "plan/rivals.h"
#include "report/verdict_text.h"

namespace lacuna {
namespace {

using Kind = HypothesisProbability::Kind;

// Simulated recordings per protocol and rival: frequencies to within 0.035.
constexpr int kDraws = 200;

// The influence of everything that is weighed on a planned recording.
struct Influence {
  std::string message;  // why the model cannot play the protocol
  PlannedColumns columns;
  double seconds = 0;
  ProtocolPicture picture;
  std::vector<UntriedEffect> untried;  // as in PlannedOutcome
};

class Planner {
 public:
  Planner(const DiagnosedRun& run, PlanRecord* record);

  PlannedOutcome Play(const Protocol& protocol) const;

 private:
  Influence InfluenceOf(const Protocol& protocol) const;
  // The nuisances of the planned recording: those of the recording that it changes.
  Eigen::VectorXd ValuesOf(const CalibrationProblem& planned, const Protocol& protocol) const;
  // Whether all variants of the effect are candidates with a derivative, not pilots.
  bool HasDerivatives(const std::string& effect) const;
  // Whether the influence of the rival is that of columns which the diagnosis has kept. The columns
  // of one effect do not tell what it does at two places at once.
  bool IsKnown(const PlannedRival& rival) const;
  const CandidateEffect& Find(const WeighedHypothesis& hypothesis) const;
  void Predict(const JoinedSpace& space, PlannedOutcome* outcome) const;
  // The sizes of the rivals, now and with the planned recording.
  std::vector<PlannedSize> Sizes(const ProjectedHypotheses& now,
                                 const ProjectedHypotheses& then) const;
  // What belongs to a column of effects_.
  struct Amount {
    std::string effect;
    CandidateAmount amount;
  };
  Amount AmountAt(int column) const;
  // The evidence of each rival, by its name, to first order.
  std::map<std::string, double> EvidenceIn(const HypothesisSpace& space,
                                           const ProjectedHypotheses& projected,
                                           const Eigen::VectorXd& toward) const;

  const DiagnosedRun& run_;
  const CalibrationProblem problem_;
  PredictionStudy study_;  // at the fitted values, with the noise of the run
  std::vector<CandidateEffect> candidates_;
  PlanRecord* record_;
  HypothesisSpace effects_;         // the variants of all effects that occur in rivals
  HypothesisSpace now_;             // the rivals, with the columns of effects_
  std::vector<FoundEffect> found_;  // the rivals, in now_
};

// The effects that occur in the rivals, alone or in pairs.
std::vector<std::string> EffectsIn(const std::vector<PlannedRival>& rivals) {
  std::vector<std::string> effects;
  for (const PlannedRival& rival : rivals)
    effects.insert(effects.end(), rival.effects.begin(), rival.effects.end());
  return effects;
}

Planner::Planner(const DiagnosedRun& run, PlanRecord* record)
    : run_(run), problem_(run.fitted.study, run.fitted.mesh), record_(record) {
  study_ = problem_.StudyAt(run.fitted.values);
  study_.time_step = run.diagnosis.time_step;
  candidates_ = MakeCandidates({*problem_.body(),
                                study_.effects,
                                ScaleOf(study_),
                                study_.time_step,
                                Duration(study_),
                                {},
                                study_.candidates,
                                GrippedNodes(problem_.models().front().model())});
  std::erase_if(record->rivals, [&](const PlannedRival& rival) {
    const bool is_known = IsKnown(rival);
    if (!is_known) record->not_predicted.push_back(rival.effect);
    return !is_known;
  });
  effects_ = SpaceOfEffects(run.decision.baseline, EffectsIn(record->rivals));
  now_ = SpaceOfRivals(effects_, record->rivals);
  for (const PlannedRival& rival : record->rivals) found_.push_back(FindEffect(now_, rival.effect));
}

bool Planner::HasDerivatives(const std::string& effect) const {
  const std::vector<WeighedHypothesis>& all = run_.decision.baseline.hypotheses;
  return std::all_of(all.begin(), all.end(), [&](const WeighedHypothesis& hypothesis) {
    return hypothesis.name != effect ||
           std::any_of(candidates_.begin(), candidates_.end(),
                       [&](const CandidateEffect& candidate) {
                         return candidate.type == effect && candidate.variant == hypothesis.variant;
                       });
  });
}

bool Planner::IsKnown(const PlannedRival& rival) const {
  const auto is_weighed = [&](const std::string& effect) {
    const std::vector<WeighedHypothesis>& all = run_.decision.baseline.hypotheses;
    return std::any_of(all.begin(), all.end(), [&](const WeighedHypothesis& hypothesis) {
      return hypothesis.kind == HypothesisKind::kEffect && hypothesis.name == effect;
    });
  };
  if (rival.IsPair() && (rival.effects.front() == rival.effects.back() ||
                         !std::all_of(rival.effects.begin(), rival.effects.end(), is_weighed)))
    return false;
  return std::all_of(rival.effects.begin(), rival.effects.end(),
                     [&](const std::string& effect) { return HasDerivatives(effect); });
}

const CandidateEffect& Planner::Find(const WeighedHypothesis& hypothesis) const {
  const auto found =
      std::find_if(candidates_.begin(), candidates_.end(), [&](const CandidateEffect& candidate) {
        return candidate.type == hypothesis.name && candidate.variant == hypothesis.variant;
      });
  CHECK(found != candidates_.end()) << hypothesis.name << " " << hypothesis.variant;
  return *found;
}

Eigen::VectorXd Planner::ValuesOf(const CalibrationProblem& planned,
                                  const Protocol& protocol) const {
  const Eigen::Index of_model = static_cast<Eigen::Index>(study_.fitted.size());
  Eigen::VectorXd values = planned.Start();
  values.head(of_model) = run_.fitted.values.head(of_model);
  for (size_t r = 0; r < study_.recordings.size(); ++r) {
    const PredictedRecording& item = study_.recordings[r];
    if (item.name != protocol.recording || !item.hold) continue;
    const Eigen::VectorXd own = problem_.NuisanceOf(r, run_.fitted.values);
    values.segment<3>(of_model) = PlannedHoldForce(protocol, own.head<3>());
  }
  return values;
}

Influence Planner::InfluenceOf(const Protocol& protocol) const {
  Influence influence;
  const PlannedRecording planned = PlanRecording(protocol, study_, run_.fitted.mesh);
  influence.seconds = planned.Seconds();
  PredictionStudy study = study_;
  study.recordings = {planned.item};
  const CalibrationProblem problem(study, run_.fitted.mesh);
  const Eigen::VectorXd values = ValuesOf(problem, protocol);
  const Eigen::Vector3d hold = planned.item.hold
                                   ? Eigen::Vector3d(problem.NuisanceOf(0, values).head<3>())
                                   : Eigen::Vector3d(Eigen::Vector3d::Zero());
  influence.picture = PictureOf(planned, run_.fitted.mesh, hold);

  std::vector<CandidateEffect> effects;
  for (const WeighedHypothesis& hypothesis : effects_.hypotheses)
    effects.push_back(Find(hypothesis));
  const LinearisedWithGrips linearised = LineariseWithGrips(problem, values, DirectionsOf(effects));
  const LinearisedMisfit& misfit = linearised.misfit;
  if (!misfit.usable) {
    influence.message = misfit.message;
    return influence;
  }
  const Eigen::Index of_model = static_cast<Eigen::Index>(study.fitted.size());
  const Eigen::MatrixXd grip_columns = linearised.OfGrips();
  Eigen::MatrixXd own = misfit.jacobian.middleCols(of_model, linearised.parameters - of_model);
  std::vector<LinearPrior> own_priors = PriorsAbout(problem.parameters(), values);
  own_priors.erase(own_priors.begin(), own_priors.begin() + of_model);
  for (const NuisanceCandidate& nuisance :
       NuisancesOfEveryModel({problem, values, misfit, linearised.grips, grip_columns})) {
    AppendColumns(nuisance.columns, nuisance.priors, &own, &own_priors);
    if (!nuisance.untried.empty())
      influence.untried.push_back({nuisance.card.name, nuisance.untried});
  }
  for (LinearPrior& prior : own_priors) prior = {0, prior.deviation, false};

  const auto whiten = [&](const Eigen::MatrixXd& columns) {
    return WhitenedRows(columns, misfit,
                        {.correlation_time = run_.diagnosis.noise.correlation_time});
  };
  influence.columns = {whiten(misfit.jacobian.leftCols(of_model)), whiten(own),
                       std::move(own_priors), whiten(linearised.OfDirections())};
  return influence;
}

std::map<std::string, double> Planner::EvidenceIn(const HypothesisSpace& space,
                                                  const ProjectedHypotheses& projected,
                                                  const Eigen::VectorXd& toward) const {
  std::map<std::string, double> evidence;
  for (const NamedEvidence& named :
       SumVariants(space, projected.LogBayesFactors(projected.Project(toward))))
    evidence[named.name] = named.evidence;
  return evidence;
}

void Planner::Predict(const JoinedSpace& space, PlannedOutcome* outcome) const {
  const HypothesisSpace& joined = space.joined();
  const ProjectedHypotheses beside(joined), beside_now(now_);
  const std::map<std::string, double> before = EvidenceIn(now_, beside_now, now_.model.toward());
  const std::vector<HypothesisProbability>& all = run_.diagnosis.decision.probabilities;
  std::vector<HypothesisProbability> kept;  // nothing, and the rivals, without nuisances
  for (const HypothesisProbability& one : all) {
    const bool is_rival = IsOfEffects(one) && before.count(RivalName(EffectsOf(all, one))) > 0;
    if (one.kind != Kind::kNothing && !is_rival) continue;
    kept.push_back(one);
    if (is_rival) kept.back().names = EffectsOf(all, one);
  }
  for (size_t k = 0; k < found_.size(); ++k) {
    int right = 0;
    for (int draw = 0; draw < kDraws; ++draw) {
      const std::map<std::string, double> after = EvidenceIn(
          joined, beside,
          space.DrawToward(found_[k], run_.decision.seed + k, static_cast<uint64_t>(draw)));
      std::vector<HypothesisProbability> posterior = kept;
      for (HypothesisProbability& one : posterior)
        if (IsOfEffects(one))
          one.evidence += after.at(RivalName(one.names)) - before.at(RivalName(one.names));
      SetPosterior(&posterior);
      const Naming naming = NameFrom(posterior);
      if (naming.level == Naming::Level::kCommon && naming.names == record_->rivals[k].effects)
        ++right;
    }
    outcome->named.push_back(static_cast<double>(right) / kDraws);
    outcome->probability += record_->rivals[k].probability * outcome->named.back();
  }
  const std::vector<RecordedSeparation> now = SeparationsOf(now_, found_);
  const std::vector<RecordedSeparation> then = SeparationsOf(joined, found_);
  for (size_t k = 0; k < now.size(); ++k)
    outcome->pairs.push_back({now[k].first, now[k].second, now[k].lambda, then[k].lambda});
  outcome->sizes = Sizes(beside_now, beside);
}

std::vector<PlannedSize> Planner::Sizes(const ProjectedHypotheses& now,
                                        const ProjectedHypotheses& then) const {
  const Eigen::VectorXd projected_now = now.Project(now.space().model.toward());
  const Eigen::VectorXd projected_then = then.Project(then.space().model.toward());
  std::vector<PlannedSize> sizes;
  for (size_t k = 0; k < found_.size(); ++k) {
    const FoundEffect& rival = found_[k];
    for (size_t h = 0; h < now_.hypotheses.size(); ++h) {
      if (now_.hypotheses[h].columns != rival.columns) continue;
      const Eigen::MatrixXd covariance_now = now.AmountsOf(h, projected_now).covariance;
      const Eigen::MatrixXd covariance_then = then.AmountsOf(h, projected_then).covariance;
      for (size_t a = 0; a < rival.columns.size(); ++a) {
        const Eigen::Index at = static_cast<Eigen::Index>(a);
        const auto [effect, amount] = AmountAt(rival.columns[a]);
        const bool is_pair = record_->rivals[k].IsPair();
        sizes.push_back({rival.name, is_pair ? effect + "." + amount.name : amount.name,
                         amount.unit, rival.amounts[at],
                         kNormalQuantile * std::sqrt(covariance_now(at, at)),
                         kNormalQuantile * std::sqrt(covariance_then(at, at))});
      }
    }
  }
  return sizes;
}

Planner::Amount Planner::AmountAt(int column) const {
  for (const WeighedHypothesis& hypothesis : effects_.hypotheses) {
    const std::vector<int>& columns = hypothesis.columns;
    const auto at = std::find(columns.begin(), columns.end(), column);
    if (at == columns.end()) continue;
    return {hypothesis.name,
            AmountsOf(Find(hypothesis)).at(static_cast<size_t>(at - columns.begin()))};
  }
  LOG(FATAL) << "no effect has the column " << column;
}

PlannedOutcome Planner::Play(const Protocol& protocol) const {
  PlannedOutcome outcome;
  outcome.name = protocol.name;
  outcome.what = DescribeProtocol(protocol);
  Influence influence;
  try {
    influence = InfluenceOf(protocol);
  } catch (const InputError& problem) {
    influence.message = problem.what();
  }
  outcome.seconds = influence.seconds;
  outcome.message = influence.message;
  outcome.picture = std::move(influence.picture);
  outcome.untried = std::move(influence.untried);
  if (outcome.IsPlayable()) Predict(JoinedSpace(now_, influence.columns), &outcome);
  return outcome;
}

// How often recordings like those of the run lead to the name of each rival: from the diagnosis,
// which has simulated that for the most probable effects, and simulated here for the others. A
// rival that the residual does not show keeps 0: at the size 0 nothing leads to its name. So does a
// pair, because that simulation decides between single effects.
void SetNamedNow(const DiagnosedRun& run, std::vector<PlannedRival>* rivals) {
  const auto find = [](const std::vector<RecordedPower>& all, const std::string& effect) {
    return std::find_if(all.begin(), all.end(), [&](const RecordedPower& power) {
      return power.truth == std::vector<std::string>{effect};
    });
  };
  std::vector<RecordedPower> known = run.diagnosis.decision.power;
  std::vector<std::string> missing;
  for (const PlannedRival& rival : *rivals)
    if (!rival.IsPair() && find(known, rival.effect) == known.end())
      missing.push_back(rival.effect);
  if (!missing.empty()) {
    const std::vector<RecordedPower> simulated = SimulatePower(run.decision, missing);
    known.insert(known.end(), simulated.begin(), simulated.end());
  }
  for (PlannedRival& rival : *rivals)
    if (const auto power = find(known, rival.effect); power != known.end())
      rival.named_now = power->named;
}

// Throws InputError where all that the diagnosis keeps contain the same effects, so that it says
// that these are missing: what else is missing shows in a model that has them.
void RequireNoCommonEffect(const DiagnosisRecord& diagnosis, const PlanRecord& plan) {
  const Naming naming = NameFrom(diagnosis.decision.probabilities);
  if (plan.rivals.empty() || naming.level != Naming::Level::kCommon) return;
  std::vector<std::string> names;
  for (const PlannedRival& rival : plan.rivals) names.push_back(rival.effect);
  throw InputError(
      fmt::format("all hypotheses that the diagnosis of {0} keeps ({1}) contain {2}: add {2} to "
                  "the model first, then fit, diagnose and plan again",
                  plan.run, fmt::join(names, ", "), fmt::join(naming.names, " and ")));
}

}  // namespace

PlanRecord MakePlan(const DiagnosedRun& run, const std::vector<Protocol>& protocols,
                    Progress* progress) {
  PlanRecord record;
  record.run = run.fitted.study.name;
  record.verdict = VerdictWithNames(run.diagnosis);
  const std::vector<HypothesisProbability>& all = run.diagnosis.decision.probabilities;
  record.rivals = RivalsOf(run.diagnosis);
  for (const HypothesisProbability& one : all)
    if (!IsOfEffects(one)) record.no_effect += one.probability;
  std::set<std::vector<std::string>> kept;  // by their effects, where they have any
  for (const size_t k : NameFrom(all).kept) {
    if (all[k].kind == Kind::kNuisance)
      record.also_left.push_back({all[k].names.front(),
                                  ShortTitle(run.diagnosis, all[k].names.front()),
                                  all[k].probability});
    kept.insert(IsOfEffects(all[k]) ? EffectsOf(all, all[k]) : all[k].names);
  }
  if (kept.size() > 1) RequireNoCommonEffect(run.diagnosis, record);
  if (record.rivals.empty() || kept.size() < 2)
    throw InputError(fmt::format(
        "the diagnosis of {} has left no rivals: there is nothing that a further recording would "
        "have to decide",
        record.run));
  while (record.rivals.size() > kMostPlannedRivals) {
    record.not_predicted.push_back(record.rivals.back().effect);
    record.rivals.pop_back();
  }
  const Planner planner(run, &record);  // leaves out rivals whose influence it cannot predict
  if (record.rivals.empty())
    throw InputError(
        fmt::format("the influence of {} on another recording cannot be predicted to "
                    "first order",
                    fmt::join(record.not_predicted, ", ")));
  SetNamedNow(run, &record.rivals);
  double sum = 0;
  for (const PlannedRival& rival : record.rivals) sum += rival.probability;
  for (PlannedRival& rival : record.rivals) {
    rival.of_diagnosis = rival.probability;
    rival.probability =
        sum > 0 ? rival.probability / sum : 1 / static_cast<double>(record.rivals.size());
  }
  progress->Begin("plan", static_cast<int64_t>(protocols.size()));
  record.outcomes.resize(protocols.size());
  std::atomic<int64_t> done = 0;
  ParallelFor(static_cast<int64_t>(protocols.size()), 1, [&](int64_t k) {
    record.outcomes[static_cast<size_t>(k)] = planner.Play(protocols[static_cast<size_t>(k)]);
    progress->Report(++done);
  });
  progress->End(fmt::format("{} protocols", protocols.size()));
  SortOutcomes(&record.outcomes);
  return record;
}

}  // namespace lacuna
