#include "study/diagnosis.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/atomic_file.h"
#include "effects/catalogue.h"

namespace lacuna {
namespace {

using Verdict = Diagnosis::Verdict;

// What is left is noise below so many standard deviations.
constexpr double kAtNoise = 1.2;
// An effect must take this share of the held-out square error away to be worth naming, and a rival
// must leave at least this much more rms than the best to be ruled out.
constexpr double kWorthNaming = 0.25;
constexpr double kRuledOut = 1.1;
// How far beyond the plausible range a refit may go, in parts of that range.
constexpr double kMargin = 0.1;
// Evidence (a natural logarithm) below which an effect is not worth a refit.
constexpr double kNoEvidence = 3;

struct Errors {
  double in_fit = 0, held_out = 0, in_noise = 0;
  bool has_held_out = false;
};

// Over all recordings; without held-out frames the fitted ones stand for them.
Errors ErrorsOf(const CalibrationProblem& problem, const Eigen::VectorXd& values) {
  double fitted = 0, held_out = 0;
  int fitted_points = 0, held_out_points = 0;
  for (const RecordingMisfit& recording : problem.Misfits(values)) {
    fitted += recording.in_fit.rms * recording.in_fit.rms * recording.in_fit.points;
    fitted_points += recording.in_fit.points;
    held_out += recording.held_out.rms * recording.held_out.rms * recording.held_out.points;
    held_out_points += recording.held_out.points;
  }
  Errors errors;
  errors.has_held_out = held_out_points > 0;
  if (fitted_points > 0) errors.in_fit = std::sqrt(fitted / fitted_points);
  errors.held_out = errors.has_held_out ? std::sqrt(held_out / held_out_points) : errors.in_fit;
  errors.in_noise = errors.held_out / (std::sqrt(3.0) * problem.noise());
  return errors;
}

void Refit(const CalibrationProblem& problem, const TetMesh& mesh, const Eigen::VectorXd& values,
           RankedEffect* ranked, Progress* progress) {
  const PredictionStudy study = WithEffect(problem.study(), ranked->scored);
  const CalibrationProblem with(study, mesh);
  const Eigen::Index shared = static_cast<Eigen::Index>(problem.study().fitted.size());
  const Eigen::Index added = static_cast<Eigen::Index>(study.fitted.size()) - shared;
  Eigen::VectorXd start = with.Start();
  start.head(shared) = values.head(shared);
  start.tail(start.size() - shared - added) = values.tail(values.size() - shared);
  ranked->refitted = true;
  // A rival need not be at its very best to be told from one that fits.
  ranked->calibration = with.Fit(start, progress, {.max_iterations = 12});
  if (ranked->calibration.estimates.empty()) {
    ranked->refit_message = ranked->calibration.message;
    return;
  }
  const Errors errors = ErrorsOf(with, ranked->calibration.parameters);
  ranked->in_fit_rms = errors.in_fit;
  ranked->held_out_rms = errors.held_out;
  ranked->in_noise = errors.in_noise;
}

const RankedEffect* Find(const std::vector<RankedEffect>& ranking, const std::string& type) {
  for (const RankedEffect& effect : ranking)
    if (effect.scored.candidate.type == type) return &effect;
  return nullptr;
}

// The refits that came to something, the least held-out error first.
std::vector<const RankedEffect*> UsableRefits(const std::vector<RankedEffect>& ranking) {
  std::vector<const RankedEffect*> refits;
  for (const RankedEffect& effect : ranking)
    if (effect.refitted && effect.refit_message.empty()) refits.push_back(&effect);
  std::stable_sort(refits.begin(), refits.end(),
                   [](const auto* a, const auto* b) { return a->held_out_rms < b->held_out_rms; });
  return refits;
}

std::string Titles(const std::vector<std::string>& types) {
  std::vector<std::string> titles;
  for (const std::string& type : types) titles.push_back(FindEntry(type)->card->title);
  return fmt::format("{}", fmt::join(titles, "; "));
}

// No effect, at the largest size that is plausible, would stand out from the noise.
bool NothingCouldBeSeen(const std::vector<RankedEffect>& ranking) {
  for (const RankedEffect& effect : ranking) {
    const EffectCard& card = effect.scored.candidate.effect->Card();
    for (size_t k = 0; k < effect.scored.candidate.amplitude.size(); ++k) {
      const ParameterCard& parameter = card.parameters[effect.scored.candidate.amplitude[k]];
      if (effect.scored.score.detectable[static_cast<Eigen::Index>(k)] < PlausibleScale(parameter))
        return false;
    }
  }
  return true;
}

void Decide(Diagnosis* diagnosis) {
  if (NothingCouldBeSeen(diagnosis->ranking)) {
    diagnosis->verdict = Verdict::kNoPower;
    diagnosis->explanation =
        "no effect of plausible size would show in these recordings beyond what the fitted "
        "parameters can do: more motion, other loads or less noise are needed";
    return;
  }
  const std::vector<const RankedEffect*> refitted = UsableRefits(diagnosis->ranking);
  const double base = diagnosis->held_out_rms;
  const double best_left = refitted.empty() ? base : refitted.front()->held_out_rms;
  const double gain = base > 0 ? 1 - best_left * best_left / (base * base) : 0;
  const bool something = diagnosis->in_noise > kAtNoise;

  if (!something && gain < kWorthNaming) {
    diagnosis->verdict = Verdict::kAdequate;
    diagnosis->explanation = fmt::format(
        "the error, {:.3f} mm or {:.1f} σ, is that of the noise; no effect would lower "
        "it by more than {:.0f} %",
        1e3 * base, diagnosis->in_noise, 100 * kWorthNaming);
    return;
  }
  // Whatever a finer mesh would explain as well is not evidence of physics.
  if (diagnosis->mesh_share > kWorthNaming && diagnosis->mesh_share > gain) {
    diagnosis->verdict = Verdict::kNuisance;
    diagnosis->effects = {"mesh"};
    diagnosis->explanation = fmt::format(
        "{:.0f} % of what is left changes with the mesh and the step: refine them before looking "
        "for physics",
        100 * diagnosis->mesh_share);
    return;
  }
  if (gain < kWorthNaming) {
    diagnosis->verdict = Verdict::kNotInLibrary;
    diagnosis->explanation = fmt::format(
        "{:.3f} mm or {:.1f} σ are left, and no effect of the catalogue lowers the held-out error "
        "by more than {:.0f} %",
        1e3 * base, diagnosis->in_noise, 100 * std::max(gain, 0.0));
    return;
  }
  const RankedEffect& best = *refitted.front();
  diagnosis->effects = {best.scored.candidate.type};
  for (size_t k = 1; k < refitted.size(); ++k)
    if (refitted[k]->held_out_rms < kRuledOut * best_left)
      diagnosis->effects.push_back(refitted[k]->scored.candidate.type);
  // Look-alikes that were not refitted cannot be ruled out either.
  for (const std::string& other : best.scored.look_alikes) {
    const RankedEffect* rival = Find(diagnosis->ranking, other);
    if (rival != nullptr && !rival->refitted) diagnosis->effects.push_back(other);
  }
  const std::string drop =
      fmt::format("from {:.3f} mm ({:.1f} σ) to {:.3f} mm ({:.1f} σ)", 1e3 * base,
                  diagnosis->in_noise, 1e3 * best_left, best.in_noise);
  const std::string where = diagnosis->has_held_out ? "held-out" : "fitted";
  if (diagnosis->effects.size() == 1) {
    diagnosis->verdict = Verdict::kMissing;
    diagnosis->explanation =
        fmt::format("{}: with it the {} error falls {}", Titles(diagnosis->effects), where, drop);
  } else {
    diagnosis->verdict = Verdict::kAmbiguous;
    diagnosis->explanation = fmt::format(
        "{}: this recording cannot tell them apart; with the best the {} error falls {}",
        Titles(diagnosis->effects), where, drop);
    diagnosis->experiment = best.scored.candidate.effect->Card().separating_experiment;
  }
}

nlohmann::json Number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

}  // namespace

std::string VerdictName(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAdequate:
      return "adequate";
    case Verdict::kMissing:
      return "missing";
    case Verdict::kAmbiguous:
      return "ambiguous";
    case Verdict::kNuisance:
      return "nuisance";
    case Verdict::kNotInLibrary:
      return "not in library";
    case Verdict::kNoPower:
      break;
  }
  return "no power";
}

PredictionStudy WithEffect(const PredictionStudy& study, const ScoredEffect& scored) {
  PredictionStudy with = study;
  const CatalogueEntry* entry = FindEntry(scored.candidate.type);
  Eigen::VectorXd values = scored.candidate.effect->Parameters();
  const EffectCard& card = *entry->card;
  for (size_t k = 0; k < scored.candidate.amplitude.size(); ++k) {
    const int index = scored.candidate.amplitude[k];
    const ParameterCard& parameter = card.parameters[index];
    const double size = scored.score.size[static_cast<Eigen::Index>(k)];
    // Within what is plausible, and not at the null value, where other parameters have no meaning.
    double start = std::clamp(size, parameter.plausible_min, parameter.plausible_max);
    if (start == parameter.null_value) start += 0.01 * PlausibleScale(parameter);
    values[index] = start;
  }
  const std::shared_ptr<Effect> effect = entry->make(values);
  with.effects.push_back(effect);
  for (ModelParameter& parameter : ModelParameters(with.effects)) {
    if (parameter.places.front().first == effect) {
      // Where another effect is what is missing, a fit would make this one do its work at any size.
      const auto& [place, index] = parameter.places.front();
      const ParameterCard& plausible = place->Card().parameters[index];
      const double margin = kMargin * (plausible.plausible_max - plausible.plausible_min);
      CalibratedParameter& prior = parameter.prior;
      prior.max = std::min(prior.max, plausible.plausible_max + margin);
      prior.min = std::max(prior.min, plausible.log_scale && plausible.plausible_min > 0
                                          ? 0.5 * plausible.plausible_min
                                          : plausible.plausible_min - margin);
      with.fitted.push_back(parameter);
      continue;
    }
    // A modulus that the effect shares with the material moves with it.
    for (ModelParameter& known : with.fitted)
      if (known.places.front() == parameter.places.front()) known.places = parameter.places;
  }
  return with;
}

Diagnosis Diagnose(const CalibrationProblem& problem, const TetMesh& mesh,
                   const Eigen::VectorXd& values, const DiagnosisOptions& options,
                   Progress* progress) {
  Diagnosis diagnosis;
  diagnosis.noise = problem.noise();
  EffectRanking ranking = RankEffects(problem, values, progress);
  diagnosis.mesh_share = ranking.mesh_share;
  diagnosis.scored = ranking.variants;
  for (ScoredEffect& effect : ranking.effects) {
    diagnosis.ranking.emplace_back();
    diagnosis.ranking.back().scored = std::move(effect);
  }

  const Errors errors = ErrorsOf(problem, values);
  diagnosis.in_fit_rms = errors.in_fit;
  diagnosis.held_out_rms = errors.held_out;
  diagnosis.in_noise = errors.in_noise;
  diagnosis.has_held_out = errors.has_held_out;

  const auto refit = [&](RankedEffect* ranked) {
    Refit(problem, mesh, values, ranked, progress);
    problem.SetModel(values);  // the refit has changed effects that both models share
  };
  int refits = 0;
  for (RankedEffect& ranked : diagnosis.ranking) {
    if (refits == options.refits || ranked.scored.score.evidence < kNoEvidence) break;
    ++refits;
    refit(&ranked);
  }
  // First order cannot tell the best from its look-alikes; a refit may.
  const std::vector<const RankedEffect*> usable = UsableRefits(diagnosis.ranking);
  if (!usable.empty()) {
    const std::vector<std::string> look_alikes = usable.front()->scored.look_alikes;
    refits = 0;
    for (RankedEffect& ranked : diagnosis.ranking) {
      const bool is_one =
          std::count(look_alikes.begin(), look_alikes.end(), ranked.scored.candidate.type) > 0;
      if (!is_one || ranked.refitted || refits == options.refits) continue;
      ++refits;
      refit(&ranked);
    }
  }
  Decide(&diagnosis);
  return diagnosis;
}

void SaveDiagnosis(const Diagnosis& diagnosis, const std::filesystem::path& file) {
  nlohmann::json ranking = nlohmann::json::array();
  for (const RankedEffect& effect : diagnosis.ranking) {
    nlohmann::json sizes = nlohmann::json::array();
    for (size_t k = 0; k < effect.scored.parameters.size(); ++k) {
      const Eigen::Index at = static_cast<Eigen::Index>(k);
      sizes.push_back({{"parameter", effect.scored.parameters[k]},
                       {"unit", effect.scored.units[k]},
                       {"expected", effect.scored.score.size[at]},
                       {"deviation", Number(effect.scored.score.deviation[at])},
                       {"detectable", Number(effect.scored.score.detectable[at])}});
    }
    nlohmann::json entry = {{"effect", effect.scored.candidate.type},
                            {"variant", effect.scored.candidate.variant},
                            {"evidence", effect.scored.score.evidence},
                            {"explained_share", effect.scored.score.explained},
                            {"absorbed_share", effect.scored.score.absorbed},
                            {"sizes", sizes},
                            {"look_alikes", effect.scored.look_alikes},
                            {"refitted", effect.refitted}};
    if (effect.refitted) {
      entry["refit"] = {{"message", effect.refit_message},
                        {"in_fit_rms_m", effect.in_fit_rms},
                        {"held_out_rms_m", effect.held_out_rms},
                        {"held_out_in_noise", effect.in_noise}};
    }
    ranking.push_back(entry);
  }
  const nlohmann::json all = {{"schema_version", 1},
                              {"verdict", VerdictName(diagnosis.verdict)},
                              {"effects", diagnosis.effects},
                              {"explanation", diagnosis.explanation},
                              {"experiment", diagnosis.experiment},
                              {"noise_m", diagnosis.noise},
                              {"in_fit_rms_m", diagnosis.in_fit_rms},
                              {"held_out_rms_m", diagnosis.held_out_rms},
                              {"held_out_in_noise", diagnosis.in_noise},
                              {"has_held_out", diagnosis.has_held_out},
                              {"mesh_share", diagnosis.mesh_share},
                              {"ranking", ranking}};
  WriteFileAtomically(file, all.dump(2) + "\n");
}

}  // namespace lacuna
