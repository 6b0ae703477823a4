#include "trials/trial_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/median.h"
#include "trials/case_files.h"
#include "trials/trial_case.h"
#include "trials/trial_run.h"

namespace lacuna {
namespace {

constexpr double kAtNoise = 1.2;
constexpr double kWithin = 0.15;

double MedianOrZero(const std::vector<double>& values) {
  return values.empty() ? 0 : Median(values);
}

std::string RowOf(const TrialCase& trial) {
  const std::string group = TrialGroupName(trial.group);
  if (trial.group == TrialGroup::kHardControl) return group + " " + trial.nuisance;
  const std::string row = fmt::format("{}, {} rec", group, trial.recordings);
  if (trial.group != TrialGroup::kOneEffect) return row;
  return fmt::format("{}, {:g} x", row, trial.hidden[0].factor);
}

void Count(const TrialCase& trial, const TrialOutcome& outcome, TrialTally* tally) {
  ++tally->cases;
  ++tally->verdicts[VerdictName(outcome.verdict)];
  const bool is_stated = outcome.verdict == Verdict::kMissing;
  const bool is_removed = trial.group == TrialGroup::kRemoved;
  const auto is_right = [&](const std::string& name) { return !is_removed && trial.Hides(name); };
  const std::vector<std::string>& named = outcome.named;
  const bool only_right = is_stated && std::all_of(named.begin(), named.end(), is_right);
  tally->wrong += is_stated && !only_right;
  if (trial.hidden.empty() || is_removed) return;
  ++tally->nameable;
  tally->pairs += trial.hidden.size() == 2;
  const bool names_all =
      std::all_of(trial.hidden.begin(), trial.hidden.end(), [&](const HiddenEffect& hidden) {
        return std::find(named.begin(), named.end(), hidden.type) != named.end();
      });
  tally->top1 += only_right && names_all;
  tally->in_part += only_right && !names_all;
  const auto among_first = [&](size_t count) {
    const auto first = outcome.ranked.begin();
    const auto end = first + static_cast<std::ptrdiff_t>(std::min(count, outcome.ranked.size()));
    return std::any_of(first, end, is_right);
  };
  const bool is_ambiguous = outcome.verdict == Verdict::kAmbiguous;
  tally->top2 += only_right || ((is_stated || is_ambiguous) && among_first(2)) ||
                 (is_ambiguous && std::any_of(named.begin(), named.end(), is_right));
  tally->ranked_first += among_first(1);
  if (!outcome.has_truth) return;
  ++tally->fitted;
  tally->at_noise += outcome.error_after <= kAtNoise;
  tally->within_15 += outcome.relative_error <= kWithin;
  for (const char covered : outcome.covered) {
    ++tally->intervals;
    tally->covered += covered;
  }
}

// The row of the confusion matrix.
std::string HiddenIn(const TrialCase& trial) {
  if (trial.hidden.empty()) return "nothing";
  std::vector<std::string> types;
  for (const HiddenEffect& hidden : trial.hidden) types.push_back(hidden.type);
  std::sort(types.begin(), types.end());
  return fmt::format("{}{}", fmt::join(types, " + "),
                     trial.group == TrialGroup::kRemoved ? " (removed)" : "");
}

std::string Share(int part, int whole) {
  return whole > 0 ? fmt::format("{:.0f} %", 100.0 * part / whole) : "-";
}

}  // namespace

TrialReport ReportTrials(const std::filesystem::path& folder) {
  TrialReport report;
  std::map<std::string, TrialTally> tallies;
  std::map<std::string, std::vector<double>> before, after;
  std::vector<double> seconds;
  std::vector<FinishedTrial> finished;
  for (const std::filesystem::path& own : CasesIn(folder)) {
    const TrialCase trial = ReadCase(own);
    if (!std::filesystem::exists(own / kOutcomeFile)) {
      report.unfinished.push_back(trial.name);
      continue;
    }
    const TrialOutcome outcome = ReadTrialOutcome(own);
    finished.push_back({trial, outcome});
    const std::string group = RowOf(trial);
    tallies[group].group = group;
    Count(trial, outcome, &tallies[group]);
    before[group].push_back(outcome.error_before);
    if (outcome.has_truth) after[group].push_back(outcome.error_after);
    seconds.push_back(outcome.seconds);
    std::map<std::string, int>& said = report.confusion[HiddenIn(trial)];
    if (outcome.verdict == Verdict::kMissing)
      for (const std::string& name : outcome.named) ++said[name];
    else
      ++said[VerdictName(outcome.verdict)];
  }
  for (const std::filesystem::path& own : SkippedCasesIn(folder))
    report.skipped.push_back(own.filename().string());
  report.median_seconds = MedianOrZero(seconds);
  report.rates = RatesOf(finished);
  report.follow_ups = ReportFollowUps(folder);
  for (auto& [group, tally] : tallies) {
    tally.median_before = MedianOrZero(before[group]);
    tally.median_after = MedianOrZero(after[group]);
    report.tallies.push_back(tally);
  }
  return report;
}

std::string ReportInWords(const TrialReport& report) {
  std::string text = fmt::format(
      "{:28} {:>5} {:>7} {:>7} {:>7} {:>6} {:>10} {:>8} {:>10} {:>11} {:>8} {:>7}  {}\n", "group",
      "cases", "correct", "in part", "top two", "wrong", "ranked 1st", "at noise", "size ±15 %",
      "in interval", "σ before", "σ after", "verdicts");
  for (const TrialTally& tally : report.tallies) {
    std::vector<std::string> verdicts;
    for (const auto& [name, count] : tally.verdicts)
      verdicts.push_back(fmt::format("{} {}", count, name));
    text += fmt::format(
        "{:28} {:>5} {:>7} {:>7} {:>7} {:>6} {:>10} {:>8} {:>10} {:>11} {:>8.2f} {:>7}  {}\n",
        tally.group, tally.cases, Share(tally.top1, tally.nameable),
        Share(tally.in_part, tally.pairs), Share(tally.top2, tally.nameable),
        Share(tally.wrong, tally.cases), Share(tally.ranked_first, tally.nameable),
        Share(tally.at_noise, tally.fitted), Share(tally.within_15, tally.fitted),
        Share(tally.covered, tally.intervals), tally.median_before,
        tally.fitted > 0 ? fmt::format("{:.2f}", tally.median_after) : "-",
        fmt::join(verdicts, ", "));
  }
  text += "\nhidden effect: verdicts, or the effects named as missing\n";
  for (const auto& [truth, said] : report.confusion) {
    std::vector<std::string> parts;
    for (const auto& [name, count] : said) parts.push_back(fmt::format("{} {}", count, name));
    text += fmt::format("  {:44} {}\n", truth, fmt::join(parts, ", "));
  }
  text += "\n" + RatesInWords(report.rates) + FollowUpsInWords(report.follow_ups);
  text += fmt::format("\nmedian time for the fit and the diagnosis of a case: {:.0f} s\n",
                      report.median_seconds);
  if (!report.unfinished.empty())
    text += fmt::format("cases without an outcome: {}\n", report.unfinished.size());
  if (!report.skipped.empty())
    text += fmt::format("cases that could not be made: {}; {} in their folders has the reasons\n",
                        report.skipped.size(), kSkippedFile);
  return text;
}

void WriteTrialReport(const TrialReport& report, const std::filesystem::path& folder) {
  nlohmann::json tallies = nlohmann::json::array();
  for (const TrialTally& tally : report.tallies)
    tallies.push_back({{"group", tally.group},
                       {"cases", tally.cases},
                       {"nameable", tally.nameable},
                       {"pairs", tally.pairs},
                       {"top1", tally.top1},
                       {"in_part", tally.in_part},
                       {"top2", tally.top2},
                       {"wrong", tally.wrong},
                       {"ranked_first", tally.ranked_first},
                       {"verdicts", tally.verdicts},
                       {"fitted", tally.fitted},
                       {"at_noise", tally.at_noise},
                       {"within_15_percent", tally.within_15},
                       {"intervals", tally.intervals},
                       {"covered", tally.covered},
                       {"median_error_before", tally.median_before},
                       {"median_error_after", tally.median_after}});
  nlohmann::json all = {{"schema_version", 1},
                        {"tallies", tallies},
                        {"confusion", report.confusion},
                        {"median_seconds", report.median_seconds},
                        {"unfinished", report.unfinished},
                        {"skipped", report.skipped}};
  all.update(RatesToJson(report.rates));
  all["follow_ups"] = FollowUpsToJson(report.follow_ups);
  WriteFileAtomically(folder / "report.json", all.dump(2) + "\n");
  WriteFileAtomically(folder / "report.txt", ReportInWords(report));
}

}  // namespace lacuna
