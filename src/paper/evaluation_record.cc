#include "paper/evaluation_record.h"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "core/blas_kernels.h"
#include "core/error.h"
#include "core/json_number.h"
#include "core/text_file.h"
#include "record/json_hash.h"
#include "registration/gaussian_sums.h"

namespace lacuna {
namespace {

std::string KeyOf(const SearchedParameters& p) {
  return fmt::format("{:a} {:a} {:a} {:a}", p.radius_edge_ratio, p.max_volume, p.young_modulus,
                     p.poisson_ratio);
}

constexpr char kHash[] = "hash", kInstructions[] = "instructions";

// The hash of a line's content. Two runs write the same one, because the wall time is left out.
std::string HashOf(const nlohmann::json& line) {
  return HashWithout(line, {"/hash", "/evaluation/seconds"});
}

// Keys of the derivatives, in the order of ObjectiveEvaluation::by_moduli.
constexpr const char* kModuli[] = {"by_young_modulus", "by_poisson_ratio"};

ObjectiveEvaluation EvaluationFrom(const nlohmann::json& json) {
  ObjectiveEvaluation evaluation;
  evaluation.usable = json.at("usable");
  evaluation.failure = json.at("failure");
  evaluation.residual_sum = NumberOr(json.at("residual_sum_m"));
  evaluation.residual_per_point = NumberOr(json.at("residual_per_point_m"));
  evaluation.residual_rms = NumberOr(json.value("residual_rms_m", nlohmann::json()));
  evaluation.scan_distance = NumberOr(json.at("scan_distance_m"));
  evaluation.force = NumberOr(json.at("net_force_N"));
  evaluation.nodes = json.at("nodes");
  evaluation.tets = json.at("tetrahedra");
  evaluation.surface_points = json.at("surface_points");
  evaluation.seconds = json.at("seconds");
  for (const char* name : kModuli) {
    if (!json.contains(name)) continue;
    const nlohmann::json& by = json.at(name);
    evaluation.by_moduli.push_back(
        {by.at("residual_sum"), by.at("residual_per_point"), by.at("residual_rms")});
  }
  return evaluation;
}

}  // namespace

nlohmann::json ToJson(const SearchedParameters& parameters) {
  return {{"radius_edge_ratio", parameters.radius_edge_ratio},
          {"max_volume_m3", parameters.max_volume},
          {"young_modulus_Pa", parameters.young_modulus},
          {"poisson_ratio", parameters.poisson_ratio}};
}

SearchedParameters SearchedParametersFrom(const nlohmann::json& json) {
  return {json.at("radius_edge_ratio"), json.at("max_volume_m3"), json.at("young_modulus_Pa"),
          json.at("poisson_ratio")};
}

nlohmann::json ToJson(const ObjectiveEvaluation& evaluation) {
  nlohmann::json json{{"usable", evaluation.usable},
                      {"failure", evaluation.failure},
                      {"residual_sum_m", NumberOrNull(evaluation.residual_sum)},
                      {"residual_per_point_m", NumberOrNull(evaluation.residual_per_point)},
                      {"residual_rms_m", NumberOrNull(evaluation.residual_rms)},
                      {"scan_distance_m", NumberOrNull(evaluation.scan_distance)},
                      {"net_force_N", NumberOrNull(evaluation.force)},
                      {"nodes", evaluation.nodes},
                      {"tetrahedra", evaluation.tets},
                      {"surface_points", evaluation.surface_points},
                      {"seconds", evaluation.seconds}};
  for (size_t i = 0; i < evaluation.by_moduli.size(); ++i) {
    const ObjectiveSlope& by = evaluation.by_moduli[i];
    json[kModuli[i]] = {{"residual_sum", by.residual_sum},
                        {"residual_per_point", by.residual_per_point},
                        {"residual_rms", by.residual_rms}};
  }
  return json;
}

std::string InstructionsInUse() {
  const char* registration = "baseline";
  switch (BestKernels().set) {
    case InstructionSet::kBaseline:
      break;
    case InstructionSet::kAvx2:
      registration = "AVX2";
      break;
    case InstructionSet::kAvx512:
      registration = "AVX-512";
      break;
  }
  return fmt::format("{}, {}", registration, BlasKernelName());
}

EvaluationRecord::EvaluationRecord(const std::filesystem::path& file, const std::string& key,
                                   const std::string& instructions)
    : file_(file), instructions_(instructions) {
  std::string text;
  if (std::filesystem::exists(file)) {
    text = ReadWholeFile(file);
    const size_t whole = text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1;
    if (whole < text.size()) std::filesystem::resize_file(file, whole);
    text.resize(whole);
  }
  if (text.empty()) {
    AppendLine({{"objective", key}});
  } else {
    Read(text, key);
  }
}

void EvaluationRecord::Read(const std::string& text, const std::string& key) {
  std::istringstream lines(text);
  int number = 0;
  bool is_hashed = false;  // files of earlier versions are not
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const auto refuse_damage = [&](const std::string& fault) {
      throw InputError(
          {file_.string(), number},
          fmt::format("the line is damaged{}; remove this file, and what it held is computed again",
                      fault));
    };
    try {
      const nlohmann::json json = nlohmann::json::parse(line);
      if (number == 1) is_hashed = json.contains(kHash);
      if (is_hashed && json.value(kHash, "") != HashOf(json)) refuse_damage("");
      if (number == 1) {
        if (json.at("objective") == key) continue;
        throw InputError({file_.string(), number},
                         "was made with other settings or by another version of Lacuna; remove "
                         "this file to compute it anew, or choose another output folder");
      }
      known_[KeyOf(SearchedParametersFrom(json.at("parameters")))] =
          EvaluationFrom(json.at("evaluation"));
      const std::string made_with = json.value(kInstructions, instructions_);
      if (made_with != instructions_) other_instructions_.insert(made_with);
    } catch (const nlohmann::json::exception& problem) {
      refuse_damage(fmt::format(" ({})", problem.what()));
    }
  }
}

const ObjectiveEvaluation* EvaluationRecord::Find(const SearchedParameters& parameters) const {
  const auto found = known_.find(KeyOf(parameters));
  return found == known_.end() ? nullptr : &found->second;
}

void EvaluationRecord::AppendLine(nlohmann::json line) {
  line[kHash] = HashOf(line);
  std::ofstream stream(file_, std::ios::app);
  stream << line.dump() << "\n" << std::flush;
  if (!stream) throw InputError(SourcePosition{file_.string()}, "cannot be written");
}

void EvaluationRecord::Append(const SearchedParameters& parameters,
                              const ObjectiveEvaluation& evaluation) {
  AppendLine({{"parameters", ToJson(parameters)},
              {"evaluation", ToJson(evaluation)},
              {kInstructions, instructions_}});
  known_[KeyOf(parameters)] = evaluation;
}

const ObjectiveEvaluation& EvaluationRecord::FindOrEvaluate(const ParameterObjective& problem,
                                                            const SearchedParameters& parameters) {
  if (Find(parameters) == nullptr) Append(parameters, EvaluateObjective(problem, parameters));
  return *Find(parameters);
}

}  // namespace lacuna
