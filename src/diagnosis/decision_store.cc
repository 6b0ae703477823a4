#include "diagnosis/decision_store.h"

#include <fmt/format.h>

#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/hash.h"
#include "core/json_file.h"
#include "core/json_number.h"
#include "core/npy.h"
#include "record/schema_version.h"

namespace lacuna {
namespace {

using nlohmann::json;

constexpr int kSchemaVersion = 7;
constexpr double kNoPrior = std::numeric_limits<double>::infinity();

constexpr std::pair<HypothesisKind, const char*> kKinds[] = {
    {HypothesisKind::kEffect, "effect"},
    {HypothesisKind::kNuisance, "nuisance"},
    {HypothesisKind::kUnknownForce, "unknown_force"}};

// The matrices of a decision, by the hashes of their numbers.
using Matrices = std::map<std::string, Eigen::MatrixXd>;

std::string ProductsFile(const std::string& hash) { return fmt::format("products_{}.npy", hash); }

bool IsProductsFile(const std::filesystem::path& file) {
  return file.filename().string().starts_with("products_") && file.extension() == ".npy";
}

std::string HashOf(const Eigen::MatrixXd& matrix) {
  return HashBytes({reinterpret_cast<const char*>(matrix.data()),
                    static_cast<size_t>(matrix.size()) * sizeof(double)});
}

Eigen::MatrixXd ProductsOf(const LinearGaussianModel& model) {
  const Eigen::Index size = model.products().rows();
  Eigen::MatrixXd all(size + 1, size + 1);
  all(0, 0) = model.squares();
  all.col(0).tail(size) = model.toward();
  all.row(0).tail(size) = model.toward().transpose();
  all.bottomRightCorner(size, size) = model.products();
  return all;
}

// Adds the matrix of the space to `matrices`.
json SpaceToJson(const HypothesisSpace& space, Matrices* matrices) {
  Eigen::MatrixXd products = ProductsOf(space.model);
  const std::string hash = HashOf(products);
  matrices->emplace(hash, std::move(products));
  json priors = json::array(), hypotheses = json::array();
  for (const LinearPrior& prior : space.model.priors())
    priors.push_back({NumberOrNull(prior.deviation), prior.positive});
  for (const WeighedHypothesis& one : space.hypotheses) {
    const char* kind = "";
    for (const auto& [known, name] : kKinds)
      if (known == one.kind) kind = name;
    hypotheses.push_back({{"kind", kind},
                          {"name", one.name},
                          {"variant", one.variant},
                          {"columns", one.columns},
                          {"selection_penalty", one.selection_penalty}});
  }
  return {{"products", hash},        {"variance", space.variance},
          {"rows", space.rows},      {"model_error", space.model_error},
          {"base", space.base},      {"priors", priors},
          {"hypotheses", hypotheses}};
}

// The matrix with this hash.
Eigen::MatrixXd ReadProducts(const std::filesystem::path& folder, const std::string& hash) {
  const std::filesystem::path file = folder / ProductsFile(hash);
  Eigen::MatrixXd products = ReadNpyMatrix(file);
  if (HashOf(products) != hash)
    throw InputError({file.string()}, "is not as it was written: run `lacuna diagnose` again");
  return products;
}

HypothesisSpace SpaceFromJson(const json& value, const std::filesystem::path& folder) {
  std::vector<LinearPrior> priors;
  for (const json& prior : value.at("priors"))
    priors.push_back({0, NumberOr(prior.at(0), kNoPrior), prior.at(1).get<bool>()});
  const std::string hash = value.at("products");
  const Eigen::MatrixXd all = ReadProducts(folder, hash);
  const Eigen::Index size = static_cast<Eigen::Index>(priors.size());
  if (all.rows() != size + 1 || all.cols() != size + 1)
    throw InputError(
        {(folder / ProductsFile(hash)).string()},
        fmt::format("has {} rows; expected {}, as in decision.json", all.rows(), size + 1));
  HypothesisSpace space;
  space.model = LinearGaussianModel::FromProducts(
      all(0, 0), all.col(0).tail(size), all.bottomRightCorner(size, size), std::move(priors));
  space.variance = value.at("variance");
  space.rows = value.at("rows");
  space.model_error = value.at("model_error");
  space.base = value.at("base").get<std::vector<int>>();
  for (const json& one : value.at("hypotheses")) {
    WeighedHypothesis& hypothesis = space.hypotheses.emplace_back();
    for (const auto& [kind, name] : kKinds)
      if (one.at("kind") == name) hypothesis.kind = kind;
    hypothesis.name = one.at("name");
    hypothesis.variant = one.at("variant");
    hypothesis.columns = one.at("columns").get<std::vector<int>>();
    hypothesis.selection_penalty = one.at("selection_penalty");
  }
  return space;
}

json RefitsToJson(const std::vector<WeighedRefit>& refits, Matrices* matrices) {
  json all = json::array();
  for (const WeighedRefit& refit : refits)
    all.push_back({{"effect", refit.effect},
                   {"evidence", refit.evidence},
                   {"predicts", refit.predicts},
                   {"space", SpaceToJson(refit.space, matrices)}});
  return all;
}

// Removes the matrices in the folder that do not belong to the decision. One that cannot be removed
// does no harm, because decision.json does not name it.
void RemoveOthers(const Matrices& matrices, const std::filesystem::path& folder) {
  std::set<std::filesystem::path> named;
  for (const auto& [hash, products] : matrices) named.insert(ProductsFile(hash));
  std::vector<std::filesystem::path> others;
  std::error_code ignored;
  for (std::filesystem::directory_iterator at(folder, ignored), end; !ignored && at != end;
       at.increment(ignored))
    if (IsProductsFile(at->path()) && !named.contains(at->path().filename()))
      others.push_back(at->path());
  for (const std::filesystem::path& other : others) std::filesystem::remove(other, ignored);
}

}  // namespace

void WriteDecisionInput(const DecisionInput& input, const std::filesystem::path& folder) {
  MakeFolder(folder);
  Matrices matrices;
  json pairs = json::array(), nuisances = json::array(), families = json::object();
  for (const WeighedPair& pair : input.pairs)
    pairs.push_back({{"first", pair.first},
                     {"second", pair.second},
                     {"gain", pair.gain},
                     {"predicts", pair.predicts},
                     {"space", SpaceToJson(pair.space, &matrices)}});
  for (const WeighedNuisance& nuisance : input.nuisances)
    nuisances.push_back({{"name", nuisance.name}, {"evidence", nuisance.evidence}});
  for (const auto& [effect, family] : input.families) families[effect] = FamilyName(family);
  const json all = {{"schema_version", kSchemaVersion},
                    {"baseline", SpaceToJson(input.baseline, &matrices)},
                    {"refits", RefitsToJson(input.refits, &matrices)},
                    {"pairs", pairs},
                    {"failed_pairs", input.failed_pairs},
                    {"nuisances", nuisances},
                    {"adopted", input.adopted},
                    {"adopted_evidence", input.adopted_evidence},
                    {"in_place_of_adopted", RefitsToJson(input.in_place_of_adopted, &matrices)},
                    {"families", families},
                    {"natural_value", input.natural_value},
                    {"explained_misfit", input.explained_misfit},
                    {"noise_is_known", input.noise_is_known},
                    {"is_anything_detectable", input.is_anything_detectable},
                    {"seed", input.seed}};
  // Until decision.json names them, the new matrices stand beside those of the decision before.
  for (const auto& [hash, products] : matrices) WriteNpy(folder / ProductsFile(hash), products);
  WriteFileAtomically(folder / "decision.json", all.dump(1) + "\n");
  RemoveOthers(matrices, folder);
}

DecisionInput ReadDecisionInput(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "decision.json";
  return ReadJsonFile(file, [&](const json& value) {
    RequireSchemaVersion(value, kSchemaVersion, "lacuna diagnose");
    DecisionInput input;
    input.baseline = SpaceFromJson(value.at("baseline"), folder);
    const auto read_refits = [&](const char* key) {
      std::vector<WeighedRefit> refits;
      for (const json& one : value.at(key))
        refits.push_back({one.at("effect"), one.at("evidence"),
                          SpaceFromJson(one.at("space"), folder), one.at("predicts")});
      return refits;
    };
    input.refits = read_refits("refits");
    input.in_place_of_adopted = read_refits("in_place_of_adopted");
    for (const json& one : value.at("pairs"))
      input.pairs.push_back({one.at("first"), one.at("second"), one.at("gain"),
                             SpaceFromJson(one.at("space"), folder), one.at("predicts")});
    input.failed_pairs = value.at("failed_pairs").get<std::vector<std::array<std::string, 2>>>();
    for (const json& one : value.at("nuisances"))
      input.nuisances.push_back({one.at("name"), one.at("evidence")});
    input.adopted = value.at("adopted").get<std::vector<std::string>>();
    input.adopted_evidence = value.at("adopted_evidence");
    for (const auto& [effect, family] : value.at("families").items())
      input.families[effect] = FamilyFromName(family);
    input.natural_value = value.at("natural_value").get<std::map<std::string, double>>();
    input.explained_misfit = value.at("explained_misfit");
    input.noise_is_known = value.at("noise_is_known");
    input.is_anything_detectable = value.at("is_anything_detectable");
    input.seed = value.at("seed");
    return input;
  });
}

}  // namespace lacuna
