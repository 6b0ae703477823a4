#include "study/effect_ranking.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "scan/random_bits.h"

namespace lacuna {
namespace {

// First order cannot tell effects apart whose derivatives are this parallel.
constexpr double kLookAlike = 0.95;
// A nuisance is taken for granted with odds of e⁵, and where no effect explains as much.
constexpr double kAdopted = 5;
constexpr int kMostAdopted = 3;
constexpr double kSeen = 1e-8;  // of a column's square: less is the rounding of projecting it out
// What the mesh changes is taken from time steps so many times as long, to find where its limit
// would be fitted: it is simulated again from there with the right ones.
constexpr double kLongSteps = 3;
constexpr int kMostStepsToLimit = 4;
constexpr double kAtLimit = 1;  // of ‖r‖², that a step no longer gains

std::vector<int> Range(Eigen::Index first, Eigen::Index count) {
  std::vector<int> range(static_cast<size_t>(count));
  std::iota(range.begin(), range.end(), static_cast<int>(first));
  return range;
}

std::vector<int> Joined(std::vector<int> a, const std::vector<int>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// Columns of all hypotheses, one after another.
struct Hypotheses {
  Eigen::MatrixXd by;
  std::vector<LinearPrior> priors;

  std::vector<int> Add(const Eigen::MatrixXd& columns, const std::vector<LinearPrior>& more) {
    const Eigen::Index first = by.cols();
    if (by.rows() == 0) by.resize(columns.rows(), 0);
    by.conservativeResize(Eigen::NoChange, first + columns.cols());
    by.rightCols(columns.cols()) = columns;
    priors.insert(priors.end(), more.begin(), more.end());
    return Range(first, columns.cols());
  }
};

// The same columns seen by all frames and by the fitted ones.
struct Weighed {
  LinearModel all, fitted;
  Eigen::VectorXd residual;  // whitened, of all frames
  Eigen::MatrixXd columns;
};

Weighed Weigh(const LinearisedMisfit& misfit, const Hypotheses& hypotheses,
              double correlation_time) {
  Eigen::MatrixXd rows(misfit.residual.size(), hypotheses.by.cols() + 1);
  rows << misfit.residual, hypotheses.by;
  const Eigen::MatrixXd all = WhitenedRows(rows, misfit, correlation_time, false);
  const Eigen::MatrixXd fitted = WhitenedRows(rows, misfit, correlation_time, true);
  const Eigen::Index count = hypotheses.by.cols();
  return {LinearModel(all.col(0), all.rightCols(count), hypotheses.priors),
          LinearModel(fitted.col(0), fitted.rightCols(count), hypotheses.priors), all.col(0),
          all.rightCols(count)};
}

// Expected error of the held-out frames after a fit of the fitted ones.
double ExpectedHeldOut(const Weighed& weighed, const std::vector<int>& chosen, double variance,
                       const LinearisedMisfit& misfit) {
  const LinearFit fit = weighed.fitted.Fit(chosen, variance);
  return HeldOutInNoise(weighed.residual + weighed.columns(Eigen::all, chosen) * fit.change,
                        misfit);
}

std::vector<LinearPrior> PriorsOf(const CandidateEffect& candidate) {
  std::vector<LinearPrior> priors;
  for (const CandidateAmount& amount : AmountsOf(candidate))
    priors.push_back({0, amount.plausible, amount.is_positive});
  return priors;
}

Score ScoreOf(const Weighed& weighed, const std::vector<int>& base, const LinearFit& before,
              const std::vector<int>& own, double variance, const LinearisedMisfit& misfit) {
  Score score;
  const std::vector<int> with = Joined(base, own);
  const LinearFit after = weighed.all.Fit(with, variance);
  const Eigen::Index count = static_cast<Eigen::Index>(own.size());
  score.evidence = after.log_evidence - before.log_evidence;
  score.size = after.change.tail(count);
  score.deviation = after.deviation.tail(count);
  score.explained = before.misfit > 0 ? std::clamp(1 - after.misfit / before.misfit, 0.0, 1.0) : 0;
  score.held_out_in_noise = ExpectedHeldOut(weighed, with, variance, misfit);
  const Eigen::MatrixXd remaining = weighed.all.Remaining(base, own, own, variance);
  double raw = 0, visible = 0;
  score.detectable.setConstant(count, std::numeric_limits<double>::infinity());
  for (Eigen::Index k = 0; k < count; ++k) {
    const double unit = std::pow(weighed.all.Prior(own[k]).deviation, 2);
    const double square = weighed.all.Square(own[k]);
    raw += unit * square;
    visible += unit * remaining(k, k);
    if (remaining(k, k) > kSeen * square && remaining(k, k) > 0)
      score.detectable[k] = kStandsOut * std::sqrt(variance / remaining(k, k));
  }
  if (raw > 0) score.absorbed = std::clamp(1 - visible / raw, 0.0, 1.0);
  return score;
}

// The largest evidence that all effects find in nineteen of twenty residuals that no effect has
// made: what `best` leaves, shuffled.
double ControlEvidence(const Weighed& weighed, const LinearisedMisfit& misfit,
                       const std::vector<int>& best, const std::vector<int>& base,
                       const std::vector<std::vector<int>>& effects, double variance) {
  constexpr int kDraws = 20;
  const Eigen::VectorXd left =
      weighed.residual + weighed.columns(Eigen::all, best) * weighed.all.Fit(best, variance).change;
  std::vector<double> largest;
  for (uint64_t draw = 0; draw < kDraws; ++draw) {
    Eigen::VectorXd shuffled = left;
    for (const LinearisedMisfit::Part& part : misfit.parts) {
      const Eigen::Index frames = static_cast<Eigen::Index>(part.layout.times.size());
      const Eigen::Index series = part.layout.series;
      const Eigen::Index shift = static_cast<Eigen::Index>(RandomBits({draw, part.recording, 1}) %
                                                           static_cast<uint64_t>(frames));
      for (Eigen::Index s = 0; s < series; ++s) {
        const double sign =
            RandomBits({draw, part.recording, 2, static_cast<uint64_t>(s)}) % 2 == 0 ? 1 : -1;
        for (Eigen::Index f = 0; f < frames; ++f)
          shuffled[part.first_row + f * series + s] =
              sign * left[part.first_row + (f + shift) % frames * series + s];
      }
    }
    const LinearModel control = weighed.all.WithResidual(shuffled, weighed.columns);
    const double before = control.Fit(base, variance).log_evidence;
    double most = 0;
    for (const std::vector<int>& effect : effects)
      most = std::max(most, control.Fit(Joined(base, effect), variance).log_evidence - before);
    largest.push_back(most);
  }
  std::sort(largest.begin(), largest.end());
  return largest[kDraws - 2];
}

std::vector<MisfitDirection> DirectionsOf(const std::vector<CandidateEffect>& candidates) {
  std::vector<MisfitDirection> directions;
  for (const CandidateEffect& candidate : candidates)
    for (const int parameter : candidate.amplitude)
      directions.push_back({{.effect = candidate.effect, .parameter = parameter}});
  return directions;
}

double Duration(const PredictionStudy& study) {
  double duration = 0;
  for (const PredictedRecording& item : study.recordings)
    duration = std::max(duration, item.recording.times[item.frames.back()] -
                                      item.recording.times[item.frames.front()]);
  return duration;
}

}  // namespace

double Price(size_t rivals) { return std::log(static_cast<double>(std::max<size_t>(rivals, 1))); }

Eigen::VectorXd AtMeshLimit(const CalibrationProblem& problem, const Eigen::VectorXd& values) {
  const LinearisedMisfit misfit = problem.Linearise(values, true);
  if (!misfit.usable) return values;
  const Eigen::VectorXd change = ChangeByMesh(problem, values, kLongSteps);
  if (change.size() != misfit.residual.size()) return values;
  const Eigen::MatrixXd by = WhitenedRows(misfit.by, misfit, 0, false);
  const auto left = [&](const LinearisedMisfit& there) -> Eigen::VectorXd {
    return WhitenedRows(there.residual + change, misfit, 0, false);
  };
  // The derivatives hardly change on the way: a few steps with the same ones.
  Eigen::VectorXd best = values;
  Eigen::VectorXd here = left(misfit);
  for (int step = 0; step < kMostStepsToLimit; ++step) {
    const LinearFit fit = LinearModel(here, by, PriorsAbout(problem.parameters(), best)).FitAll(1);
    const Eigen::VectorXd moved = MovedBy(problem.parameters(), best, fit.change);
    const LinearisedMisfit there = problem.Linearise(moved, false, {}, &misfit);
    if (!there.usable) break;
    const Eigen::VectorXd next = left(there);
    const double gain = here.squaredNorm() - next.squaredNorm();
    if (!(gain > 0)) break;
    best = moved;
    here = next;
    if (gain < kAtLimit) break;
  }
  return best;
}

EffectRanking RankEffects(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                          Progress* progress, const std::vector<std::string>& without) {
  EffectRanking ranking;
  const PredictionStudy& study = problem.study();
  progress->Begin("score", 0);
  problem.SetModel(values);  // the effects as fitted: candidates take moduli from them
  std::vector<CandidateEffect> candidates =
      MakeCandidates({*problem.body(), study.effects, study.time_step, Duration(study), without});
  const GripNuisances grips(problem);
  std::vector<MisfitDirection> directions = DirectionsOf(candidates);
  const Eigen::Index effect_columns = static_cast<Eigen::Index>(directions.size());
  directions.insert(directions.end(), grips.directions().begin(), grips.directions().end());
  const LinearisedMisfit misfit = problem.Linearise(values, true, directions);
  CHECK(misfit.usable) << "the fitted model could be predicted before: " << misfit.message;
  const Eigen::Index known = static_cast<Eigen::Index>(problem.parameters().size());

  Hypotheses hypotheses;
  const std::vector<int> parameters =
      hypotheses.Add(misfit.by.leftCols(known), PriorsAbout(problem.parameters(), values));
  std::vector<std::vector<int>> own;  // columns of each candidate
  Eigen::Index column = known;
  for (const CandidateEffect& candidate : candidates) {
    const Eigen::Index width = static_cast<Eigen::Index>(candidate.amplitude.size());
    own.push_back(hypotheses.Add(misfit.by.middleCols(column, width), PriorsOf(candidate)));
    column += width;
  }
  PilotHypotheses pilots = RunPilots(problem, values, misfit, without);
  for (PilotHypothesis& pilot : pilots.tried) {
    own.push_back(hypotheses.Add(pilot.by, PriorsOf(pilot.candidate)));
    candidates.push_back(std::move(pilot.candidate));
  }
  ranking.untried = std::move(pilots.untried);
  std::vector<int> base = parameters;
  const auto add_nuisance = [&](NuisanceCandidate candidate, bool adopted) {
    const std::vector<int> columns = hypotheses.Add(candidate.by, candidate.priors);
    ranking.nuisances.push_back({std::move(candidate), 0, 0, adopted});
    if (adopted) base = Joined(base, columns);
    return columns;
  };
  // What a finer discretisation would do is nobody's merit; nor is what the object's dimensions do,
  // of which bending stiffness goes with the cube.
  std::vector<std::vector<int>> of_nuisance;
  for (NuisanceCandidate& nuisance : NuisancesAlwaysTaken(problem, values, misfit))
    of_nuisance.push_back(add_nuisance(std::move(nuisance), true));

  // What no effect explains is taken for noise.
  const auto left_by = [&](const std::vector<int>& chosen) -> Eigen::VectorXd {
    const LinearFit fit =
        LinearModel(WhitenedRows(misfit.residual, misfit, 0, false),
                    WhitenedRows(hypotheses.by, misfit, 0, false), hypotheses.priors)
            .Fit(chosen, 1);
    return misfit.residual + hypotheses.by(Eigen::all, chosen) * fit.change;
  };
  const Eigen::VectorXd left = left_by(Range(0, hypotheses.by.cols()));
  ranking.noise = LevelOf(left, misfit, hypotheses.by.cols());
  for (NuisanceCandidate& nuisance : grips.Candidates(
           misfit.by.middleCols(known + effect_columns, misfit.by.cols() - known - effect_columns)))
    of_nuisance.push_back(add_nuisance(std::move(nuisance), false));
  for (NuisanceCandidate& nuisance : MeasurementNuisances(
           problem, misfit,
           WhitenedRows(left_by(base), misfit, ranking.noise.correlation_time, false)))
    of_nuisance.push_back(add_nuisance(std::move(nuisance), false));

  const Weighed weighed = Weigh(misfit, hypotheses, ranking.noise.correlation_time);
  const double variance = ranking.noise.variance;
  for (size_t k = 0; k < ranking.nuisances.size(); ++k) {
    ScoredNuisance& nuisance = ranking.nuisances[k];
    if (!nuisance.adopted) continue;
    const LinearFit without = weighed.all.Fit(parameters, variance);
    const LinearFit with = weighed.all.Fit(Joined(parameters, of_nuisance[k]), variance);
    nuisance.evidence = with.log_evidence - without.log_evidence;
    nuisance.explained = std::clamp(1 - with.misfit / without.misfit, 0.0, 1.0);
    if (nuisance.candidate.unknown.cols() == 0) continue;
    const LinearModel unknown = weighed.all.WithResidual(
        WhitenedRows(nuisance.candidate.unknown, misfit, ranking.noise.correlation_time, false),
        weighed.columns);
    nuisance.doubt = 0.5 * unknown.Fit(parameters, variance).misfit / variance;
  }
  struct Entry {
    ScoredEffect scored;
    std::vector<int> own;
    int variants = 0;
  };
  std::vector<Entry> entries;
  for (int adopted = 0;; ++adopted) {
    entries.clear();
    const LinearFit before = weighed.all.Fit(base, variance);
    for (size_t c = 0; c < candidates.size(); ++c) {
      const CandidateEffect& candidate = candidates[c];
      Score score = ScoreOf(weighed, base, before, own[c], variance, misfit);
      auto same = std::find_if(entries.begin(), entries.end(), [&](const Entry& entry) {
        return entry.scored.candidate.type == candidate.type;
      });
      if (same == entries.end()) same = entries.insert(entries.end(), Entry{});
      ++same->variants;
      if (same->variants > 1 && score.evidence <= same->scored.score.evidence) continue;
      same->scored.candidate = candidate;
      same->scored.score = std::move(score);
      same->own = own[c];
    }
    for (Entry& entry : entries)
      entry.scored.score.evidence -= Price(entry.variants) + Price(entries.size());
    std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
      return a.scored.score.evidence > b.scored.score.evidence;
    });
    ScoredNuisance* best = nullptr;
    std::vector<int> columns;
    for (size_t k = 0; k < ranking.nuisances.size(); ++k) {
      ScoredNuisance& nuisance = ranking.nuisances[k];
      if (nuisance.adopted) continue;
      const LinearFit with = weighed.all.Fit(Joined(base, of_nuisance[k]), variance);
      nuisance.evidence = with.log_evidence - before.log_evidence - nuisance.candidate.price -
                          Price(ranking.nuisances.size());
      nuisance.explained = std::clamp(1 - with.misfit / before.misfit, 0.0, 1.0);
      if (best != nullptr && nuisance.evidence <= best->evidence) continue;
      best = &nuisance;
      columns = of_nuisance[k];
    }
    const double rival = entries.empty() ? 0 : std::max(0.0, entries[0].scored.score.evidence);
    if (best == nullptr || adopted == kMostAdopted || best->evidence < rival + kAdopted) break;
    best->adopted = true;
    base = Joined(base, columns);
  }

  ranking.variants = static_cast<int>(candidates.size());
  const std::vector<int> adopted(base.begin() + known, base.end());
  ranking.adopted.by = hypotheses.by(Eigen::all, adopted);
  for (const int k : adopted) ranking.adopted.priors.push_back(hypotheses.priors[k]);
  for (Entry& entry : entries) {
    ScoredEffect& scored = entry.scored;
    for (const CandidateAmount& amount : AmountsOf(scored.candidate)) {
      scored.parameters.push_back(amount.name);
      scored.units.push_back(amount.unit);
    }
    const LinearFit fit = weighed.fitted.Fit(Joined(base, entry.own), variance);
    scored.fitted = values + fit.change.head(known);
    for (const Entry& other : entries)
      if (&other != &entry &&
          weighed.all.Collinearity(base, entry.own, other.own, variance) > kLookAlike)
        scored.look_alikes.push_back(other.scored.candidate.type);
  }
  std::vector<int> best_fit = base;
  if (!entries.empty() && entries[0].scored.score.evidence > 0)
    best_fit = Joined(base, entries[0].own);
  for (Entry& entry : entries) ranking.effects.push_back(std::move(entry.scored));
  ranking.control =
      ControlEvidence(weighed, misfit, best_fit, base, own, variance) - Price(candidates.size());
  ranking.misfit = misfit;
  ranking.misfit.by.resize(0, 0);
  progress->End(fmt::format("{} effects in {} variants", entries.size(), candidates.size()));
  return ranking;
}

}  // namespace lacuna
