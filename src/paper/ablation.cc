#include "paper/ablation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/atomic_file.h"
#include "core/csv_text.h"
#include "core/json_number.h"
#include "core/text_layout.h"

namespace lacuna {
namespace {

// The mesh noise, as a share of D, that is assumed where it was not measured.
constexpr double kAssumedNoise = 0.01;
// Ratio of the evaluation times from which on the difference is mentioned.
constexpr double kCostRatio = 1.5;

bool IsSearched(const Table1Configuration& configuration, size_t variable) {
  const SearchVariable& searched = configuration.search.variables[variable];
  return searched.lower < searched.upper;
}

const AblationRow* Find(const std::vector<AblationRow>& rows, const std::string& name) {
  for (const AblationRow& row : rows)
    if (row.name == name) return &row;
  return nullptr;
}

// The noise of D from one mesh to another, with which differences of D are compared.
struct MeshNoise {
  double share = kAssumedNoise;  // standard deviation, as a share of D
  bool is_measured = false;
};

// The error of a modulus as a factor of at least 1.
double FactorOff(double ratio) { return std::exp(std::abs(std::log(ratio))); }

std::string Compared(const AblationRow& row, const AblationRow& other, const MeshNoise& noise) {
  const double difference = row.residual.best.median / other.residual.best.median - 1;
  if (std::abs(difference) <= 2 * noise.share && noise.is_measured)
    return fmt::format("D equals that of {} within two standard deviations of the mesh noise",
                       other.name);
  if (std::abs(difference) <= 2 * noise.share)
    return fmt::format(
        "D equals that of {} within {:g} % (mesh noise not measured; {:g} % assumed)", other.name,
        200 * noise.share, 100 * noise.share);
  return fmt::format("D {:.1f} % {} than that of {}", 100 * std::abs(difference),
                     difference < 0 ? "lower" : "higher", other.name);
}

std::string ParametersInWords(const Table1Configuration& configuration, const AblationRow& row,
                              const AblationRow* other) {
  std::string text;
  if (IsSearched(configuration, 2)) {
    text += fmt::format("; y off by a factor {:.2f}", FactorOff(row.optimum.modulus_factor.median));
    if (other != nullptr)
      text += fmt::format(" ({:.2f})", FactorOff(other->optimum.modulus_factor.median));
  }
  if (IsSearched(configuration, 3)) {
    text += fmt::format("; p off by {:.3f}", std::abs(row.optimum.poisson_error.median));
    if (other != nullptr)
      text += fmt::format(" ({:.3f})", std::abs(other->optimum.poisson_error.median));
  }
  return text;
}

std::string InWords(const Table1Configuration& configuration, const AblationRow& row,
                    const AblationRow* other, const MeshNoise& noise) {
  if (row.seeds == 0) return "no evaluation succeeded";
  std::string text = "the reference of the other rows";
  if (other != nullptr) {
    text = Compared(row, *other, noise);
  } else if (!row.against.empty()) {
    text = fmt::format("no comparison: the search of {} failed", row.against);
  }
  text += ParametersInWords(configuration, row, other);
  const double below = 1 - row.residual.best.median / row.residual.at_truth.median;
  const bool seeks_material = IsSearched(configuration, 2) || IsSearched(configuration, 3);
  if (seeks_material && below > 2 * noise.share) {
    text += fmt::format(
        "; {:.1f} % below D at the true y and p, so that the smallest D does not "
        "identify them",
        100 * below);
  }
  if (other != nullptr) {
    const double cost = row.seconds.median / row.evaluations.median;
    const double ratio = cost / (other->seconds.median / other->evaluations.median);
    if (ratio > kCostRatio || ratio < 1 / kCostRatio)
      text += fmt::format("; an evaluation takes {:.1f} times as long", ratio);
  }
  if (row.failures.median > 0) text += fmt::format("; {:.0f} failed", row.failures.median);
  return text;
}

// One value per seed, in order.
struct SeedValues {
  std::vector<double> start, best, start_sum, best_sum, drop, q, v, y, p, factor, error, truth,
      evaluations, failures, seconds;
};

void Add(const Table1Study& study, const Table1Configuration& configuration,
         const Table1Search& search, SeedValues* values) {
  const ParameterSearchResult& found = search.found;
  const ObjectiveEvaluation& first = found.evaluations.front();
  const ObjectiveEvaluation& best = found.evaluations[found.best];
  const SearchedParameters& at = found.parameters[found.best];
  const ObjectiveMeasure measure = configuration.search.measure;
  values->start.push_back(first.residual_per_point);
  values->best.push_back(best.residual_per_point);
  values->start_sum.push_back(first.residual_sum);
  values->best_sum.push_back(best.residual_sum);
  values->drop.push_back(1 - ValueOf(best, measure) / ValueOf(first, measure));
  values->q.push_back(at.radius_edge_ratio);
  values->v.push_back(at.max_volume);
  values->y.push_back(at.young_modulus);
  values->p.push_back(at.poisson_ratio);
  values->factor.push_back(at.young_modulus / study.true_young_modulus);
  values->error.push_back(at.poisson_ratio - study.true_poisson_ratio);
  values->truth.push_back(search.at_truth.residual_per_point);
  values->evaluations.push_back(static_cast<double>(found.evaluations.size()));
  values->failures.push_back(found.failures);
  values->seconds.push_back(found.Seconds());
}

// The columns of the table, named with their units.
std::vector<std::pair<const char*, const SeedRange*>> ColumnsOf(const AblationRow& row) {
  return {{"start_per_point_m", &row.residual.start},
          {"best_per_point_m", &row.residual.best},
          {"start_sum_m", &row.residual.start_sum},
          {"best_sum_m", &row.residual.best_sum},
          {"drop", &row.residual.drop},
          {"radius_edge_ratio", &row.optimum.radius_edge_ratio},
          {"max_volume_m3", &row.optimum.max_volume},
          {"young_modulus_Pa", &row.optimum.young_modulus},
          {"poisson_ratio", &row.optimum.poisson_ratio},
          {"young_modulus_over_truth", &row.optimum.modulus_factor},
          {"poisson_ratio_less_truth", &row.optimum.poisson_error},
          {"truth_per_point_m", &row.residual.at_truth},
          {"evaluations", &row.evaluations},
          {"failures", &row.failures},
          {"seconds", &row.seconds}};
}

std::string QuotientText(const std::vector<MeshQuotient>& quotients) {
  if (quotients.empty()) return "";
  std::string text =
      "\nHow a gradient behaves where the mesh is made anew: central difference quotients of the "
      "value searched "
      "over\nq and v at the first row's start, mm per range, by their step in parts of the "
      "range\n";
  for (size_t i = 0; i < quotients.size();) {
    const std::string& variable = quotients[i].variable;
    text += PaddedRight(variable, 20);
    int up = 0, down = 0;
    for (; i < quotients.size() && quotients[i].variable == variable; ++i) {
      text += fmt::format("  {:g}: {:.2f}", quotients[i].step, 1e3 * quotients[i].slope);
      up += quotients[i].slope > 0;
      down += quotients[i].slope < 0;
    }
    text += up > 0 && down > 0 ? "   (both signs: no derivative)\n" : "\n";
  }
  return text;
}

std::string CsvOf(const AblationSummary& summary) {
  std::string text = "name,varies,against,seeds";
  for (const auto& column : ColumnsOf(summary.rows.front()))
    text += fmt::format(",{}", column.first);
  text += "\n";
  for (const AblationRow& row : summary.rows) {
    text += fmt::format("{},{},{},{}", CsvField(row.name), CsvField(row.varies),
                        CsvField(row.against), row.seeds);
    for (const auto& column : ColumnsOf(row)) text += fmt::format(",{}", column.second->median);
    text += "\n";
  }
  return text;
}

}  // namespace

AblationSummary SummariseAblation(const Table1Study& study, const Table1Result& result) {
  AblationSummary summary;
  const Table1Summary table = Summarise(study, result);
  summary.mesh_noise = table.mesh_noise;
  summary.turns = table.turns;
  MeshNoise noise;
  if (!std::isnan(summary.mesh_noise)) noise = {summary.mesh_noise, true};
  for (size_t c = 0; c < study.configurations.size(); ++c) {
    const Table1Configuration& configuration = study.configurations[c];
    AblationRow row;
    row.name = configuration.name;
    row.varies = configuration.varies;
    row.question = configuration.question;
    if (c > 0) {
      row.against =
          configuration.against.empty() ? study.configurations.front().name : configuration.against;
    }
    row.method_message = result.seeds.front().searches[c].found.message;
    SeedValues values;
    for (const Table1Seed& seed : result.seeds)
      if (seed.searches[c].found.IsUsable()) Add(study, configuration, seed.searches[c], &values);
    row.seeds = static_cast<int>(values.best.size());
    row.residual.start = RangeOf(values.start);
    row.residual.best = RangeOf(values.best);
    row.residual.start_sum = RangeOf(values.start_sum);
    row.residual.best_sum = RangeOf(values.best_sum);
    row.residual.drop = RangeOf(values.drop);
    row.optimum.radius_edge_ratio = RangeOf(values.q);
    row.optimum.max_volume = RangeOf(values.v);
    row.optimum.young_modulus = RangeOf(values.y);
    row.optimum.poisson_ratio = RangeOf(values.p);
    row.optimum.modulus_factor = RangeOf(values.factor);
    row.optimum.poisson_error = RangeOf(values.error);
    row.residual.at_truth = RangeOf(values.truth);
    row.evaluations = RangeOf(values.evaluations);
    row.failures = RangeOf(values.failures);
    row.seconds = RangeOf(values.seconds);
    summary.rows.push_back(std::move(row));
  }
  for (size_t c = 0; c < summary.rows.size(); ++c) {
    AblationRow& row = summary.rows[c];
    const AblationRow* other = c > 0 ? Find(summary.rows, row.against) : nullptr;
    row.shows = InWords(study.configurations[c], row,
                        other != nullptr && other->seeds > 0 ? other : nullptr, noise);
  }
  return summary;
}

std::string AblationText(const Table1Study& study, const Table1Result& result) {
  const AblationSummary summary = SummariseAblation(study, result);
  std::string text = fmt::format(
      "Medians of {} seed(s), or of those whose search succeeded where a row names fewer.\n"
      "Truth: y = {:g} kPa, p = {:g}. D per point in mm, |D_anim| in m.\n\n"
      "row                 D start    best  |D_anim|   best  drop %      q    v cm³   y kPa  "
      "y/true      p  evals failed    s\n",
      result.seeds.size(), 1e-3 * study.true_young_modulus, study.true_poisson_ratio);
  std::string varies;
  for (const AblationRow& row : summary.rows) {
    if (row.varies != varies) text += fmt::format("-- {}\n", row.varies);
    varies = row.varies;
    const auto cell = [](double value, size_t width, int digits) {
      return PaddedLeft(std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, digits), width);
    };
    text += PaddedRight(row.name, 20) + cell(1e3 * row.residual.start.median, 7, 3) +
            cell(1e3 * row.residual.best.median, 8, 3) +
            cell(row.residual.start_sum.median, 10, 3) + cell(row.residual.best_sum.median, 7, 3) +
            cell(100 * row.residual.drop.median, 8, 1) +
            cell(row.optimum.radius_edge_ratio.median, 7, 3) +
            cell(1e6 * row.optimum.max_volume.median, 9, 1) +
            cell(1e-3 * row.optimum.young_modulus.median, 8, 1) +
            cell(row.optimum.modulus_factor.median, 8, 2) +
            cell(row.optimum.poisson_ratio.median, 7, 3) + cell(row.evaluations.median, 7, 0) +
            cell(row.failures.median, 7, 0) + cell(row.seconds.median, 5, 0);
    if (static_cast<size_t>(row.seeds) < result.seeds.size())
      text += fmt::format("  {} of {} seeds", row.seeds, result.seeds.size());
    text += "\n";
  }
  text += "\nWhat each row shows (in brackets: the row that it is compared with)\n";
  for (const AblationRow& row : summary.rows) {
    text += Wrapped(row.question.empty() ? row.shows : row.question + " " + row.shows + ".",
                    PaddedRight(row.name, 20), std::string(20, ' '));
  }
  text += std::isnan(summary.mesh_noise)
              ? fmt::format("\nMesh noise: not measured; {:g} % of D per point is assumed\n",
                            100 * kAssumedNoise)
              : fmt::format("\nMesh noise: {:.2f} % of D per point, from {} turns of S_0\n",
                            100 * summary.mesh_noise, summary.turns);
  return text + QuotientText(result.quotients);
}

void WriteAblation(const Table1Study& study, const Table1Result& result,
                   const std::filesystem::path& folder) {
  const AblationSummary summary = SummariseAblation(study, result);
  nlohmann::json json;
  json["truth"] = {{"young_modulus_Pa", study.true_young_modulus},
                   {"poisson_ratio", study.true_poisson_ratio}};
  if (!std::isnan(summary.mesh_noise)) json["mesh_noise"] = summary.mesh_noise;
  for (const AblationRow& row : summary.rows) {
    nlohmann::json entry{{"name", row.name},         {"varies", row.varies},
                         {"question", row.question}, {"against", row.against},
                         {"seeds", row.seeds},       {"method_message", row.method_message},
                         {"shows", row.shows}};
    for (const auto& [name, range] : ColumnsOf(row)) entry[name] = JsonOf(*range);
    json["rows"].push_back(entry);
  }
  for (const MeshQuotient& quotient : result.quotients) {
    json["remesh_quotients"].push_back({{"variable", quotient.variable},
                                        {"step", quotient.step},
                                        {"slope_m_per_range", NumberOrNull(quotient.slope)}});
  }
  WriteFileAtomically(folder / "ablation.txt", AblationText(study, result));
  WriteFileAtomically(folder / "ablation.json", json.dump(2) + "\n");
  WriteFileAtomically(folder / "ablation.csv", CsvOf(summary));
}

void CheckAblation(const Table1Study& study) {
  for (const Table1Configuration& configuration : study.configurations) {
    const auto is_named = [&](const Table1Configuration& other) {
      return other.name == configuration.against;
    };
    if (!configuration.against.empty() &&
        std::none_of(study.configurations.begin(), study.configurations.end(), is_named))
      configuration.config.Fail("against", "names no row of the folder");
  }
}

}  // namespace lacuna
