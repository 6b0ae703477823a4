#include "paper/table1_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/atomic_file.h"
#include "core/json_number.h"
#include "paper/evaluation_record.h"
#include "record/csv_table.h"
#include "report/line_chart.h"

namespace lacuna {
namespace {

double DropOf(double from, double to) { return 1 - to / from; }

double Percent(double fraction) { return 100 * fraction; }

double LargestSum(const ParameterSearchResult& found) {
  return found.evaluations[found.Worst(ObjectiveMeasure::kSum)].residual_sum;
}

// Standard deviation over mean of the evaluations that succeeded.
double RelativeSpread(const std::vector<ObjectiveEvaluation>& evaluations,
                      ObjectiveMeasure measure) {
  double sum = 0, squares = 0;
  int count = 0;
  for (const ObjectiveEvaluation& evaluation : evaluations) {
    if (!evaluation.usable) continue;
    const double value = ValueOf(evaluation, measure);
    sum += value;
    squares += value * value;
    ++count;
  }
  if (count < 2) return kNotMeasured;
  const double mean = sum / count;
  return std::sqrt(std::max(0.0, (squares - count * mean * mean) / (count - 1))) / mean;
}

std::string Range(const SeedRange& range, const char* format, double scale = 1) {
  const auto number = [&](double value) {
    return std::isnan(value) ? "-" : fmt::format(fmt::runtime(format), scale * value);
  };
  return fmt::format("{} [{}, {}]", number(range.median), number(range.least),
                     number(range.largest));
}

std::string HoldsText(bool holds) { return holds ? "holds" : "does not hold"; }

void AppendSearches(const Table1Study& study, const Table1Result& result, std::string* text) {
  *text += fmt::format(
      "seed  search       |D_anim| m        D per point mm           q     v cm³    y kPa      p"
      "   nodes  evals (failed)  s each\n");
  for (const Table1Seed& seed : result.seeds) {
    for (size_t c = 0; c < seed.searches.size(); ++c) {
      const Table1Search& search = seed.searches[c];
      const ParameterSearchResult& found = search.found;
      const std::string& name = study.configurations[c].name;
      if (!found.IsUsable()) {
        *text += fmt::format("{:4}  {:12} no evaluation succeeded\n", seed.seed, name);
        continue;
      }
      const auto row = [&](const char* what, int k, const std::string& end) {
        const ObjectiveEvaluation& at = found.evaluations[k];
        const SearchedParameters& p = found.parameters[k];
        *text += fmt::format(
            "{:4}  {:12} {:<7} {:8.4f}   {:<7} {:8.4f}   {:6.3f}  {:8.1f}  {:7.1f}  {:5.3f}  {:6}{}"
            "\n",
            seed.seed, name, what, at.residual_sum, "", 1e3 * at.residual_per_point,
            p.radius_edge_ratio, 1e6 * p.max_volume, 1e-3 * p.young_modulus, p.poisson_ratio,
            at.nodes, end);
      };
      if (found.evaluations.front().usable) row("start", 0, "");
      row("max", search.worst, "");
      row("optimum", found.best,
          fmt::format("  {} ({})  {:.2f}", found.evaluations.size(), found.failures,
                      found.Seconds() / static_cast<double>(found.evaluations.size())));
    }
  }
}

void AppendRows(const Table1Study& study, const Table1Summary& summary, std::string* text) {
  *text += fmt::format(
      "\nDrops in %, median [least, largest] over the seeds. The paper's drop is relative to the "
      "largest value met;\nits measure is the sum over the mesh's own points.\n"
      "search       paper   searched: from max       from start               sum: from max        "
      "  "
      "  below the truth's\n");
  for (size_t c = 0; c < summary.rows.size(); ++c) {
    const Table1Row& row = summary.rows[c];
    const auto& paper = study.configurations[c].paper_drop;
    *text += fmt::format("{:12} {:>5}   {:24} {:24} {:24} {}\n", row.name,
                         paper ? fmt::format("{:.1f}", Percent(*paper)) : "-",
                         Range(row.drop_from_max, "{:.1f}", 100),
                         Range(row.drop_from_start, "{:.1f}", 100),
                         Range(row.sum_drop, "{:.1f}", 100), Range(row.below_truth, "{:.1f}", 100));
  }
  *text += fmt::format("\nFound moduli (truth: y = {:g} kPa, p = {:g})\n",
                       1e-3 * study.true_young_modulus, study.true_poisson_ratio);
  for (const Table1Row& row : summary.rows) {
    *text +=
        fmt::format("{:12} y {} kPa, p {}\n", row.name, Range(row.young_modulus, "{:.0f}", 1e-3),
                    Range(row.poisson_ratio, "{:.3f}"));
  }
}

void AppendEvidence(const Table1Study& study, const Table1Result& result,
                    const Table1Summary& summary, std::string* text) {
  if (!std::isnan(summary.mesh_noise)) {
    *text += fmt::format(
        "\nMesh noise: the same parameters on {} meshes of S_0 turned by 0.001 rad each: standard "
        "deviation\n{:.2f} % of D per point, {:.2f} % of the sum\n",
        summary.turns, Percent(summary.mesh_noise), Percent(summary.mesh_noise_of_sum));
  }
  const Table1Seed& first = result.seeds.front();
  *text += fmt::format(
      "\nWith CPD in the loop (the paper's align), seed {}: |D_anim| m, at the max and at the "
      "optimum\n",
      first.seed);
  for (size_t c = 0; c < first.searches.size(); ++c) {
    const ObjectiveEvaluation& worst = first.searches[c].worst_in_loop;
    const ObjectiveEvaluation& best = first.searches[c].best_in_loop;
    if (!worst.usable || !best.usable) continue;
    *text +=
        fmt::format("{:12} {:.4f} -> {:.4f}, {:.1f} %; per point {:.4f} -> {:.4f} mm, {:.1f} %\n",
                    study.configurations[c].name, worst.residual_sum, best.residual_sum,
                    Percent(DropOf(worst.residual_sum, best.residual_sum)),
                    1e3 * worst.residual_per_point, 1e3 * best.residual_per_point,
                    Percent(DropOf(worst.residual_per_point, best.residual_per_point)));
  }
  if (result.profile.empty()) return;
  *text +=
      "\nD per point over y, the rest at its truth, mm; mean net force of the fit, N\n"
      "y / truth    forces fitted      net force    forces as measured\n";
  for (const ModulusPoint& point : result.profile) {
    *text += fmt::format("{:<9g}    {:9.4f}          {:9.1f}    {:9.4f}\n", point.factor,
                         1e3 * point.fitted.residual_per_point, point.fitted.force,
                         1e3 * point.known.residual_per_point);
  }
}

void AppendClaims(const Table1Study& study, const Table1Summary& summary, std::string* text) {
  *text += "\nClaims of the paper\n";
  for (size_t c = 0; c < summary.rows.size(); ++c) {
    const Table1Row& row = summary.rows[c];
    *text += fmt::format(
        "- {} improves on its start in every seed, by more than two deviations of the mesh noise: "
        "{}\n",
        row.name,
        std::isnan(summary.mesh_noise)
            ? "mesh noise not measured"
            : HoldsText(row.with_start == summary.seeds &&
                        row.drop_from_start.least > 2 * summary.mesh_noise));
    if (row.with_start < summary.seeds)
      *text += fmt::format("  ({} of {} seeds have a start and a best point to compare)\n",
                           row.with_start, summary.seeds);
    const auto& paper = study.configurations[c].paper_drop;
    if (!paper) continue;
    *text += fmt::format("- {} drops by at least {:.1f} % (median): {} per point, {} as a sum\n",
                         row.name, Percent(*paper), HoldsText(row.drop_from_max.median >= *paper),
                         HoldsText(row.sum_drop.median >= *paper));
  }
  *text += fmt::format("- {} does at least as well as the better of the others: {} of {} seeds\n",
                       summary.rows.back().name, summary.last_is_best, summary.compared);
}

void WriteTraces(const Table1Study& study, const Table1Seed& seed,
                 const std::filesystem::path& folder) {
  std::vector<ChartLine> lines;
  for (size_t c = 0; c < seed.searches.size(); ++c) {
    const ParameterSearchResult& found = seed.searches[c].found;
    const auto count = static_cast<Eigen::Index>(found.evaluations.size());
    Eigen::MatrixXd columns(count, 8);
    for (Eigen::Index k = 0; k < count; ++k) {
      const ObjectiveEvaluation& at = found.evaluations[static_cast<size_t>(k)];
      const SearchedParameters& p = found.parameters[static_cast<size_t>(k)];
      columns.row(k) << static_cast<double>(k + 1), p.radius_edge_ratio, p.max_volume,
          p.young_modulus, p.poisson_ratio, at.residual_sum, at.residual_per_point, at.nodes;
    }
    const std::vector<std::string> names{
        "evaluation",    "radius_edge_ratio", "max_volume_m3",        "young_modulus_Pa",
        "poisson_ratio", "residual_sum_m",    "residual_per_point_m", "nodes"};
    CsvTable table;
    for (size_t i = 0; i < names.size(); ++i)
      table.push_back({names[i], columns.col(static_cast<Eigen::Index>(i))});
    const std::string& name = study.configurations[c].name;
    WriteCsv(table, folder / (name + ".csv"));
    lines.push_back({name, columns.col(0), 1e3 * columns.col(6)});
  }
  WriteLineChart(
      folder / "traces.svg",
      {fmt::format("Table 1, seed {}: D per point, mm", seed.seed), "evaluation", "mm", lines});
}

nlohmann::json JsonOf(const Table1Study& study, const Table1Result& result) {
  const Table1Summary summary = Summarise(study, result);
  nlohmann::json json;
  json["truth"] = {{"young_modulus_Pa", study.true_young_modulus},
                   {"poisson_ratio", study.true_poisson_ratio}};
  for (size_t c = 0; c < summary.rows.size(); ++c) {
    const Table1Row& row = summary.rows[c];
    nlohmann::json entry{{"name", row.name},
                         {"seeds", row.seeds},
                         {"drop_from_max", JsonOf(row.drop_from_max)},
                         {"drop_from_start", JsonOf(row.drop_from_start)},
                         {"sum_drop_from_max", JsonOf(row.sum_drop)},
                         {"best_per_point_m", JsonOf(row.best)},
                         {"below_truth", JsonOf(row.below_truth)},
                         {"young_modulus_Pa", JsonOf(row.young_modulus)},
                         {"poisson_ratio", JsonOf(row.poisson_ratio)}};
    if (study.configurations[c].paper_drop)
      entry["paper_drop"] = *study.configurations[c].paper_drop;
    json["rows"].push_back(entry);
  }
  if (!std::isnan(summary.mesh_noise)) {
    json["mesh_noise"] = {{"per_point", summary.mesh_noise}, {"sum", summary.mesh_noise_of_sum}};
  }
  json["last_is_best"] = {{"seeds", summary.last_is_best}, {"of", summary.compared}};
  for (const Table1Seed& seed : result.seeds) {
    for (size_t c = 0; c < seed.searches.size(); ++c) {
      const Table1Search& search = seed.searches[c];
      nlohmann::json entry{{"seed", seed.seed},
                           {"name", study.configurations[c].name},
                           {"status", ToString(search.found.status)},
                           {"evaluations", search.found.evaluations.size()},
                           {"failures", search.found.failures},
                           {"seconds", search.found.Seconds()},
                           {"trace_hash", search.found.trace_hash}};
      if (search.found.IsUsable()) {
        const auto point = [&](int k) {
          return nlohmann::json{{"parameters", ToJson(search.found.parameters[k])},
                                {"evaluation", ToJson(search.found.evaluations[k])}};
        };
        entry["start"] = point(0);
        entry["largest"] = point(search.worst);
        entry["best"] = point(search.found.best);
      }
      json["searches"].push_back(entry);
    }
  }
  return json;
}

}  // namespace

SeedRange RangeOf(std::vector<double> values) {
  std::erase_if(values, [](double value) { return std::isnan(value); });
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const size_t half = values.size() / 2;
  const double median =
      values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
  return {median, values.front(), values.back()};
}

nlohmann::json JsonOf(const SeedRange& range) {
  return {{"median", NumberOrNull(range.median)},
          {"least", NumberOrNull(range.least)},
          {"largest", NumberOrNull(range.largest)}};
}

Table1Summary Summarise(const Table1Study& study, const Table1Result& result) {
  Table1Summary summary;
  summary.seeds = static_cast<int>(result.seeds.size());
  for (size_t c = 0; c < study.configurations.size(); ++c) {
    const ObjectiveMeasure measure = study.configurations[c].search.measure;
    std::vector<double> from_max, from_start, of_sum, best, below_truth, modulus, ratio;
    for (const Table1Seed& seed : result.seeds) {
      const ParameterSearchResult& found = seed.searches[c].found;
      if (!found.IsUsable()) continue;
      const ObjectiveEvaluation& at = found.evaluations[found.best];
      const double value = ValueOf(at, measure);
      from_max.push_back(
          DropOf(ValueOf(found.evaluations[seed.searches[c].worst], measure), value));
      from_start.push_back(DropOf(ValueOf(found.evaluations.front(), measure), value));
      of_sum.push_back(DropOf(LargestSum(found), at.residual_sum));
      best.push_back(at.residual_per_point);
      below_truth.push_back(DropOf(ValueOf(seed.searches[c].at_truth, measure), value));
      modulus.push_back(found.parameters[found.best].young_modulus);
      ratio.push_back(found.parameters[found.best].poisson_ratio);
    }
    const auto with_start = std::count_if(from_start.begin(), from_start.end(),
                                          [](double drop) { return !std::isnan(drop); });
    summary.rows.push_back({study.configurations[c].name, static_cast<int>(best.size()),
                            RangeOf(from_max), RangeOf(from_start), RangeOf(of_sum), RangeOf(best),
                            RangeOf(modulus), RangeOf(ratio), RangeOf(below_truth),
                            static_cast<int>(with_start)});
  }
  for (const Table1Seed& seed : result.seeds) {
    const ParameterSearchResult& last = seed.searches.back().found;
    if (!last.IsUsable()) continue;
    bool is_best = true;
    for (size_t c = 0; c < seed.searches.size(); ++c) {
      const ParameterSearchResult& found = seed.searches[c].found;
      const ObjectiveMeasure measure = study.configurations[c].search.measure;
      if (!found.IsUsable()) continue;
      is_best = is_best && ValueOf(last.evaluations[last.best], measure) <=
                               ValueOf(found.evaluations[found.best], measure);
    }
    summary.last_is_best += is_best;
    ++summary.compared;
  }
  summary.mesh_noise = RelativeSpread(result.turned, study.configurations.front().search.measure);
  summary.mesh_noise_of_sum = RelativeSpread(result.turned, ObjectiveMeasure::kSum);
  summary.turns = static_cast<int>(
      std::count_if(result.turned.begin(), result.turned.end(),
                    [](const ObjectiveEvaluation& turned) { return turned.usable; }));
  return summary;
}

std::string Table1ClaimsText(const Table1Study& study, const Table1Result& result) {
  std::string text;
  AppendClaims(study, Summarise(study, result), &text);
  return text;
}

std::string Table1Text(const Table1Study& study, const Table1Result& result) {
  const Table1Summary summary = Summarise(study, result);
  std::string text;
  AppendSearches(study, result, &text);
  AppendRows(study, summary, &text);
  AppendEvidence(study, result, summary, &text);
  AppendClaims(study, summary, &text);
  return text;
}

void WriteTable1(const Table1Study& study, const Table1Result& result,
                 const std::filesystem::path& folder) {
  WriteFileAtomically(folder / "table1.txt", Table1Text(study, result));
  WriteFileAtomically(folder / "table1.json", JsonOf(study, result).dump(2) + "\n");
  WriteTraces(study, result.seeds.front(), folder);
}

}  // namespace lacuna
