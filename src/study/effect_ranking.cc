#include "study/effect_ranking.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace lacuna {
namespace {

// First order cannot tell effects apart whose derivatives are this parallel.
constexpr double kLookAlike = 0.95;
// The price of each rival, so that a larger catalogue does not find more.
double Price(size_t rivals) { return std::log(static_cast<double>(std::max<size_t>(rivals, 1))); }

// Columns of all candidates' amplitudes.
std::vector<MisfitDirection> DirectionsOf(const std::vector<CandidateEffect>& candidates) {
  std::vector<MisfitDirection> directions;
  for (const CandidateEffect& candidate : candidates)
    for (const int parameter : candidate.amplitude)
      directions.push_back({{.effect = candidate.effect, .parameter = parameter}});
  return directions;
}

struct Scored {
  EffectScore score;
  Eigen::MatrixXd by;
};

Scored Score(const FittedModel& fitted, const CandidateEffect& candidate,
             const Eigen::MatrixXd& by) {
  const EffectCard& card = candidate.effect->Card();
  Eigen::VectorXd scale(by.cols());
  std::vector<bool> one_sided;
  for (Eigen::Index k = 0; k < by.cols(); ++k) {
    const ParameterCard& parameter = card.parameters[candidate.amplitude[k]];
    scale[k] = PlausibleScale(parameter);
    one_sided.push_back(parameter.bounds.min >= parameter.null_value);
  }
  return {ScoreEffect(fitted, by, scale, one_sided), by};
}

// The residual's change when mesh and step are refined.
std::optional<Eigen::VectorXd> RefinedDifference(const CalibrationProblem& problem,
                                                 const Eigen::VectorXd& values,
                                                 const Eigen::VectorXd& residual) {
  PredictionStudy fine = problem.study();
  fine.noise = problem.noise();
  fine.mesh.tets.max_volume /= 3;
  fine.time_step /= 2;
  try {
    const PredictedRecording& first = fine.recordings.front();
    const ReferenceBody reference = MakeReferenceBody(
        {fine.name, first.recording, fine.mesh, fine.sheet_layers, first.frames.front()});
    const Prediction refined = CalibrationProblem(fine, reference.mesh).Predict(values, false);
    if (!refined.usable) return std::nullopt;
    return refined.residual - residual;
  } catch (const InputError&) {
    return std::nullopt;  // a shape that cannot be meshed more finely
  }
}

}  // namespace

EffectRanking RankEffects(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                          Progress* progress) {
  EffectRanking ranking;
  const PredictionStudy& study = problem.study();
  double duration = 0;
  for (const PredictedRecording& item : study.recordings)
    duration = std::max(duration, item.recording.times[item.frames.back()] -
                                      item.recording.times[item.frames.front()]);

  progress->Begin("score", 0);
  problem.SetModel(values);  // the effects as fitted: candidates take moduli from them
  const std::vector<CandidateEffect> candidates =
      MakeCandidates({*problem.body(), study.effects, study.time_step, duration});
  const Prediction linear = problem.Predict(values, true, std::numeric_limits<double>::infinity(),
                                            DirectionsOf(candidates));
  CHECK(linear.usable) << "the fitted model could be predicted before: " << linear.message;
  const Eigen::Index known = static_cast<Eigen::Index>(problem.parameters().size());
  Eigen::VectorXd prior(known);
  for (Eigen::Index k = 0; k < known; ++k) {
    const CalibratedParameter& parameter = problem.parameters()[k];
    prior[k] = parameter.prior_deviation * (parameter.log_scale ? values[k] : 1);
  }
  const std::optional<Eigen::VectorXd> refined =
      RefinedDifference(problem, values, linear.residual);
  problem.SetModel(values);  // the refined run has used the same effects
  Eigen::MatrixXd jacobian = linear.jacobian.leftCols(known);
  if (refined) {
    const FittedModel before(linear.residual, jacobian, prior);
    ranking.mesh_share =
        ScoreEffect(before, *refined, Eigen::VectorXd::Constant(1, 1), {false}).explained;
    // What finer discretisation would do is nobody's merit.
    jacobian.conservativeResize(Eigen::NoChange, known + 1);
    jacobian.col(known) = *refined;
    prior.conservativeResize(known + 1);
    prior[known] = 1;
  }
  const FittedModel fitted(linear.residual, jacobian, prior);

  // The best variant of each effect.
  struct Entry {
    ScoredEffect scored;
    Eigen::MatrixXd by;
    int variants = 0;
  };
  std::vector<Entry> entries;
  Eigen::Index column = known;
  for (const CandidateEffect& candidate : candidates) {
    const Eigen::Index width = static_cast<Eigen::Index>(candidate.amplitude.size());
    Scored scored = Score(fitted, candidate, linear.jacobian.middleCols(column, width));
    column += width;
    auto same = std::find_if(entries.begin(), entries.end(), [&](const Entry& entry) {
      return entry.scored.candidate.type == candidate.type;
    });
    if (same == entries.end()) same = entries.insert(entries.end(), Entry{});
    ++same->variants;
    if (same->variants > 1 && scored.score.evidence <= same->scored.score.evidence) continue;
    same->scored.candidate = candidate;
    same->scored.score = scored.score;
    same->by = std::move(scored.by);
  }
  for (Entry& entry : entries) {
    entry.scored.score.evidence -= Price(entry.variants) + Price(entries.size());
    const EffectCard& card = entry.scored.candidate.effect->Card();
    for (const int parameter : entry.scored.candidate.amplitude) {
      entry.scored.parameters.push_back(card.parameters[parameter].name);
      entry.scored.units.emplace_back(card.parameters[parameter].dimension.unit);
    }
  }
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.scored.score.evidence > b.scored.score.evidence;
  });
  ranking.variants = static_cast<int>(candidates.size());
  for (size_t i = 0; i < entries.size(); ++i) {
    for (size_t j = 0; j < entries.size(); ++j)
      if (i != j && Collinearity(fitted, entries[i].by, entries[j].by) > kLookAlike)
        entries[i].scored.look_alikes.push_back(entries[j].scored.candidate.type);
    ranking.effects.push_back(entries[i].scored);
  }
  progress->End(fmt::format("{} effects in {} variants", entries.size(), candidates.size()));
  return ranking;
}

}  // namespace lacuna
