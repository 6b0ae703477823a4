#include "trials/interval_trials.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "analysis/whiteness.h"
#include "calibration/calibration_run.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/json_file.h"
#include "core/progress.h"
#include "core/random_bits.h"
#include "effects/catalogue.h"
#include "effects/gravity.h"
#include "effects/standard_cards.h"
#include "fit/calibration.h"
#include "prediction/prediction_study_reader.h"
#include "report/line_chart.h"
#include "trials/case_files.h"
#include "trials/trial_simulation.h"
#include "trials/trial_suite.h"

namespace lacuna {
namespace {

constexpr char kIntervalsFile[] = "intervals.json";  // of a draw, and of all
constexpr int kIntervalsVersion = 1;
constexpr int kBins = 10;
constexpr uint64_t kShapeStream = 70, kEffectStream = 71, kPriorStream = 72;

// "attached_mass.mass" → "attached_mass", "mass"; the type of a parameter of the material is that
// of its law.
std::pair<std::string, std::string> TypeAndParameter(const std::string& name) {
  const size_t dot = name.find('.');
  if (dot == std::string::npos) return {NeoHookeanCard().type, name};
  return {name.substr(0, dot), name.substr(dot + 1)};
}

TrialPrior ReadTrialPrior(const Config& item, const IntervalSuite& suite) {
  TrialPrior prior;
  prior.name = item.Text("name");
  const auto [type, name] = TypeAndParameter(prior.name);
  std::vector<std::string> types = {NeoHookeanCard().type, StiffnessDampingCard().type};
  types.insert(types.end(), suite.modelled.begin(), suite.modelled.end());
  types.insert(types.end(), suite.missing.begin(), suite.missing.end());
  const CatalogueEntry* entry = FindEntry(type);
  const int index = entry == nullptr ? -1 : ParameterIndex(*entry->card, name);
  if (std::find(types.begin(), types.end(), type) == types.end() || index < 0 ||
      entry->card->parameters[index].setting)
    item.Fail("name", "the truth has no parameter \"" + prior.name + "\" that can be fitted");
  const ParameterCard& card = entry->card->parameters[index];
  prior.unit = card.dimension.unit;
  prior.log_scale = card.log_scale;
  prior.bounds = card.bounds;
  prior.mean = item.Quantity("mean", card.dimension, card.bounds);
  prior.deviation = item.Quantity("deviation", card.dimension, kPositive);
  if (prior.log_scale && !(prior.mean > 0))
    item.Fail("mean", "must be positive: the parameter is fitted on a logarithmic scale");
  item.RefuseUnknownKeys();
  return prior;
}

bool HasPrior(const IntervalSuite& suite, const std::string& name) {
  return std::any_of(suite.priors.begin(), suite.priors.end(),
                     [&](const TrialPrior& prior) { return prior.name == name; });
}

// An effect has one place in the truth.
void RequireDistinctEffects(const Config& config, const IntervalSuite& suite) {
  for (size_t k = 0; k < suite.modelled.size(); ++k)
    for (const EffectCard* card : {&StiffnessDampingCard(), &GravityCard()})
      if (suite.modelled[k] == card->type)
        config.FailAtItem("modelled", k,
                          fmt::format("\"{}\" is part of every model: leave it out", card->type));
  for (size_t k = 0; k < suite.missing.size(); ++k)
    if (std::count(suite.modelled.begin(), suite.modelled.end(), suite.missing[k]) > 0)
      config.FailAtItem(
          "missing", k,
          fmt::format("\"{}\" is among the effects that the model has", suite.missing[k]));
}

// The first of the draws from the prior that lies within its bounds. `number` is that of the prior
// in its suite. Throws InputError if there is none.
double Drawn(const TrialPrior& prior, uint64_t seed, uint64_t number) {
  constexpr uint64_t kMostDraws = 1000;
  for (uint64_t draw = 0; draw < kMostDraws; ++draw) {
    const double normal = Normal(draw == 0 ? RandomBits({seed, kPriorStream, number})
                                           : RandomBits({seed, kPriorStream, number, draw}));
    const double value = prior.log_scale
                             ? prior.mean * std::exp(prior.deviation / prior.mean * normal)
                             : prior.mean + prior.deviation * normal;
    if (prior.bounds.Contain(value)) return value;
  }
  throw InputError(fmt::format(
      "the prior of {} with the mean {:g} {} and the deviation {:g} {} has hardly any probability "
      "between its bounds",
      prior.name, prior.mean, prior.unit, prior.deviation, prior.unit));
}

// The true values of the parameters that are drawn, by their names in a fit.
std::map<std::string, double> TrueParameters(const TrialCase& trial) {
  std::map<std::string, double> truth = {{"young_modulus", trial.young_modulus},
                                         {"poisson_ratio", trial.poisson_ratio},
                                         {StiffnessDampingCard().type + ".beta", trial.damping}};
  for (const ModelledEffect& effect : trial.modelled)
    for (const auto& [name, start] : effect.starts)
      truth[effect.type + "." + name] = effect.parameters.at(name);
  return truth;
}

double NormalBelow(double deviations) { return 0.5 * std::erfc(-deviations / std::numbers::sqrt2); }

nlohmann::json ToJson(const std::vector<JudgedParameter>& parameters) {
  nlohmann::json list = nlohmann::json::array();
  for (const JudgedParameter& parameter : parameters)
    list.push_back({{"name", parameter.name},
                    {"unit", parameter.unit},
                    {"truth", parameter.truth},
                    {"value", parameter.value},
                    {"low", parameter.low},
                    {"high", parameter.high},
                    {"deviations", parameter.deviations}});
  return {{"schema_version", kIntervalsVersion}, {"parameters", list}};
}

std::vector<JudgedParameter> ReadJudged(const std::filesystem::path& file) {
  return ReadJsonFile(file, [&](const nlohmann::json& json) {
    if (json.at("schema_version") != kIntervalsVersion)
      throw InputError(file.string() + ": is of another version of the program; make it again");
    std::vector<JudgedParameter> parameters;
    for (const auto& item : json.at("parameters"))
      parameters.push_back({item.at("name"), item.at("unit"), item.at("truth"), item.at("value"),
                            item.at("low"), item.at("high"), item.at("deviations")});
    return parameters;
  });
}

IntervalTally TallyOf(const std::string& name, const std::vector<double>& deviations) {
  IntervalTally tally;
  tally.name = name;
  tally.draws = static_cast<int>(deviations.size());
  std::array<int, kBins> counts{};
  double squares = 0;
  for (const double deviation : deviations) {
    const double position = NormalBelow(deviation);
    tally.positions.push_back(position);
    ++counts[std::min(kBins - 1, static_cast<int>(kBins * position))];
    const double outside = 2 * std::abs(position - 0.5);
    tally.covered_50 += outside <= 0.5;
    tally.covered_80 += outside <= 0.8;
    tally.covered_95 += outside <= 0.95;
    tally.mean += deviation;
    squares += deviation * deviation;
  }
  const double count = tally.draws, expected = count / kBins;
  for (double* share : {&tally.covered_50, &tally.covered_80, &tally.covered_95, &tally.mean})
    *share /= count;
  tally.spread = std::sqrt(std::max(0.0, squares / count - tally.mean * tally.mean));
  double statistic = 0;
  for (const int in_bin : counts) statistic += std::pow(in_bin - expected, 2) / expected;
  tally.p_uniform = ChiSquareTail(statistic, kBins - 1);
  std::sort(tally.positions.begin(), tally.positions.end());
  return tally;
}

// Fits the draw in `folder`, and compares it with its truth.
void FitDraw(const std::filesystem::path& folder) {
  PredictionStudy study = ReadPredictionStudy(Config::Load(folder / kExperimentFile));
  study.output = folder / "fit";
  Progress progress({.style = ProgressStyle::kSilent});
  const CalibrationRecord record = RunCalibration(study, &progress);
  if (!record.usable) throw InputError(folder.string() + ": " + record.message);
  const std::vector<JudgedParameter> judged = Judge(record, ReadCase(folder));
  WriteFileAtomically(folder / kIntervalsFile, ToJson(judged).dump(2) + "\n");
}

}  // namespace

IntervalSuite ReadIntervalSuite(const Config& config) {
  constexpr int kMost = 1'000'000;
  IntervalSuite suite;
  config.Integer("schema_version", 1, 1);
  config.Text("name");
  suite.seed = static_cast<uint64_t>(config.Integer("seed", 0, kMost));
  suite.draws = config.Integer("draws", 1, kMost);
  suite.recordings = config.Integer("recordings", 1, 2, suite.recordings);
  suite.element_volume =
      config.Quantity("element_volume", kVolume, kPositive, suite.element_volume);
  suite.finer_truth = config.Number("finer_truth", {1, 1000}, suite.finer_truth);
  suite.true_step = config.Quantity("true_step", kTime, kPositive, suite.true_step);
  suite.noise = config.Quantity("noise", kLength, kPositive, suite.noise);
  suite.modelled = ReadEffectTypes(config, "modelled");
  suite.missing = ReadEffectTypes(config, "missing");
  RequireDistinctEffects(config, suite);
  for (const Config& item : config.Items("priors")) {
    TrialPrior prior = ReadTrialPrior(item, suite);
    if (HasPrior(suite, prior.name)) item.Fail("name", "is listed twice");
    suite.priors.push_back(std::move(prior));
  }
  for (const auto& [key, types] :
       {std::pair{"modelled", &suite.modelled}, std::pair{"missing", &suite.missing}})
    for (const std::string& type : *types) {
      const EffectCard& card = *FindEntry(type)->card;
      for (const int size : SizeParameters(card))
        if (const std::string name = type + "." + card.parameters[size].name;
            !HasPrior(suite, name))
          config.Fail(key, "priors has no entry for " + name);
    }
  config.RefuseUnknownKeys();
  return suite;
}

TrialCase DrawIntervalCase(const IntervalSuite& suite, int number) {
  TrialCase trial = DrawCase(fmt::format("{:04}", number), TrialGroup::kIntervals,
                             RandomBits({suite.seed, static_cast<uint64_t>(number)}),
                             suite.recordings, false, "");
  for (int axis = 0; axis < 3; ++axis)
    trial.true_size[axis] =
        trial.size[axis] *
        (1 + PredictionStudy{}.size_deviation *
                 Normal(RandomBits({trial.seed, kShapeStream, static_cast<uint64_t>(axis)})));
  trial.noise = suite.noise;
  trial.element_volume = suite.element_volume;
  trial.true_element_volume = suite.element_volume / suite.finer_truth;
  trial.true_step = suite.true_step;
  trial.priors = suite.priors;

  std::map<std::string, double> drawn;
  for (size_t k = 0; k < suite.priors.size(); ++k)
    drawn[suite.priors[k].name] = Drawn(suite.priors[k], trial.seed, k);
  const auto take = [&](const std::string& name, double* value) {
    if (drawn.contains(name)) *value = drawn[name];
  };
  take("young_modulus", &trial.young_modulus);
  take("poisson_ratio", &trial.poisson_ratio);
  take(StiffnessDampingCard().type + ".beta", &trial.damping);
  uint64_t effects = 0;
  const auto with_drawn = [&](const std::string& type) {
    HiddenEffect effect =
        DrawHidden(type, trial, RandomBits({trial.seed, kEffectStream, effects++}));
    for (auto& [name, value] : effect.parameters) take(type + "." + name, &value);
    return effect;
  };
  for (const std::string& type : suite.modelled) {
    ModelledEffect& modelled = trial.modelled.emplace_back();
    modelled.type = type;
    modelled.parameters = with_drawn(type).parameters;
    for (const TrialPrior& prior : suite.priors)
      if (const auto [of, name] = TypeAndParameter(prior.name); of == type)
        modelled.starts[name] = prior.mean;
  }
  for (const std::string& type : suite.missing) trial.hidden.push_back(with_drawn(type));
  return trial;
}

std::vector<JudgedParameter> Judge(const CalibrationRecord& record, const TrialCase& truth) {
  const std::map<std::string, double> known = TrueParameters(truth);
  std::vector<JudgedParameter> judged;
  for (const FittedParameter& parameter : record.parameters) {
    const auto found = known.find(parameter.name);
    if (found == known.end()) continue;
    const ParameterEstimate& estimate = parameter.estimate;
    const auto free = [&](double value) { return parameter.log_scale ? std::log(value) : value; };
    // A bound may cut the interval off on one side.
    const double centre = free(parameter.at_limit.value_or(estimate.value));
    const double half =
        std::max(free(estimate.high) - centre, centre - free(estimate.low)) / kNormalQuantile;
    judged.push_back({parameter.name, parameter.unit, found->second, estimate.value, estimate.low,
                      estimate.high, (free(found->second) - centre) / half});
  }
  return judged;
}

bool RunIntervalSuite(const IntervalSuite& suite, const std::filesystem::path& folder,
                      int workers) {
  std::vector<std::filesystem::path> draws;
  for (int k = 0; k < suite.draws; ++k) {
    const TrialCase drawn = DrawIntervalCase(suite, k);
    draws.push_back(folder / drawn.name);
    const std::filesystem::path truth = draws.back() / kTruthFile;
    if (std::filesystem::exists(truth) && ReadTextFile(truth) != TextOfCase(drawn))
      throw InputError(
          {truth.string()},
          "belongs to a draw of another suite or of another version of the program; choose another "
          "folder");
  }
  return WorkOn(draws, kIntervalsFile, workers, [&](size_t k) {
    // The truth comes first, so that a draw that cannot be simulated is reported.
    const TrialCase trial = DrawIntervalCase(suite, static_cast<int>(k));
    const bool is_new = !std::filesystem::exists(draws[k] / kTruthFile);
    if (is_new) WriteCase(trial, draws[k]);
    if (is_new || !std::filesystem::exists(draws[k] / kExperimentFile))
      SimulateCase(trial, draws[k]);
    FitDraw(draws[k]);
  });
}

IntervalReport ReportIntervals(const std::filesystem::path& folder) {
  IntervalReport report;
  std::vector<std::string> names;
  std::map<std::string, std::vector<double>> deviations;
  const std::vector<std::filesystem::path> draws = CasesIn(folder);
  if (!draws.empty())  // all draws of a suite lack the same
    for (const HiddenEffect& hidden : ReadCase(draws.front()).hidden)
      report.missing.push_back(hidden.type);
  for (const std::filesystem::path& draw : draws) {
    if (!std::filesystem::exists(draw / kIntervalsFile)) {
      std::string reason = "not fitted yet";
      if (std::ifstream stream(draw / kFailureFile); stream) std::getline(stream, reason);
      report.failed.push_back(draw.filename().string() + ": " + reason);
      continue;
    }
    for (const JudgedParameter& parameter : ReadJudged(draw / kIntervalsFile)) {
      if (!deviations.contains(parameter.name)) names.push_back(parameter.name);
      deviations[parameter.name].push_back(parameter.deviations);
    }
  }
  for (const std::string& name : names) report.tallies.push_back(TallyOf(name, deviations[name]));
  return report;
}

std::string IntervalReportInWords(const IntervalReport& report) {
  std::string text =
      fmt::format("{:28} {:>5}  {:>5} {:>5} {:>5}  {:>6} {:>6}  {:>8}\n", "parameter", "draws",
                  "50 %", "80 %", "95 %", "mean", "spread", "χ² p");
  for (const IntervalTally& tally : report.tallies)
    text += fmt::format("{:28} {:5}  {:4.0f}% {:4.0f}% {:4.0f}%  {:6.2f} {:6.2f}  {:8.2g}\n",
                        tally.name, tally.draws, 100 * tally.covered_50, 100 * tally.covered_80,
                        100 * tally.covered_95, tally.mean, tally.spread, tally.p_uniform);
  for (const std::string& failed : report.failed) text += "no fit: " + failed + "\n";
  return text;
}

void WriteIntervalReport(const IntervalReport& report, const std::filesystem::path& folder) {
  nlohmann::json tallies = nlohmann::json::array();
  LineChart chart{"Where the truth lies in the posterior",
                  "p",
                  "share of draws whose truth lies below the p-quantile",
                  {}};
  for (const IntervalTally& tally : report.tallies) {
    tallies.push_back({{"name", tally.name},
                       {"draws", tally.draws},
                       {"covered_50", tally.covered_50},
                       {"covered_80", tally.covered_80},
                       {"covered_95", tally.covered_95},
                       {"mean", tally.mean},
                       {"spread", tally.spread},
                       {"p_uniform", tally.p_uniform},
                       {"positions", tally.positions}});
    const Eigen::Index count = static_cast<Eigen::Index>(tally.positions.size());
    chart.lines.push_back({tally.name,
                           Eigen::Map<const Eigen::VectorXd>(tally.positions.data(), count),
                           Eigen::VectorXd::LinSpaced(count, 1.0 / count, 1)});
  }
  chart.lines.push_back(
      {"if the intervals are right", Eigen::Vector2d(0, 1), Eigen::Vector2d(0, 1)});
  const nlohmann::json all = {{"schema_version", kIntervalsVersion},
                              {"missing", report.missing},
                              {"failed", report.failed.size()},
                              {"parameters", tallies}};
  WriteFileAtomically(folder / kIntervalsFile, all.dump(2) + "\n");
  WriteFileAtomically(folder / "intervals.txt", IntervalReportInWords(report));
  WriteLineChart(folder / "intervals.svg", chart);
}

}  // namespace lacuna
