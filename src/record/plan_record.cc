#include "record/plan_record.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <tuple>

#include "core/atomic_file.h"
#include "core/json_file.h"
#include "core/json_number.h"
#include "record/schema_version.h"

namespace lacuna {
namespace {

using nlohmann::json;

constexpr int kSchemaVersion = 4;
// Probabilities of a right name are rounded to multiples of this before they are compared.
constexpr double kNoticeable = 0.05;

json PictureToJson(const ProtocolPicture& picture) {
  json curves = json::array();
  for (const ProtocolCurve& curve : picture.curves)
    curves.push_back({{"what", curve.what},
                      {"component", curve.component},
                      {"unit", curve.unit},
                      {"values", curve.values}});
  return {{"times_s", picture.times},
          {"release_s", picture.release ? json(*picture.release) : json()},
          {"curves", curves}};
}

json OutcomeToJson(const PlannedOutcome& outcome, const std::vector<PlannedRival>& rivals) {
  json named = json::object(), pairs = json::array(), sizes = json::array();
  json untried = json::array();
  for (size_t k = 0; k < outcome.named.size(); ++k) named[rivals[k].effect] = outcome.named[k];
  for (const PlannedPair& pair : outcome.pairs)
    pairs.push_back({{"first", pair.first},
                     {"second", pair.second},
                     {"lambda_now", pair.lambda_now},
                     {"lambda_then", pair.lambda_then}});
  for (const PlannedSize& size : outcome.sizes)
    sizes.push_back({{"effect", size.effect},
                     {"parameter", size.parameter},
                     {"unit", size.unit},
                     {"value", NumberOrNull(size.value)},
                     {"half_width_now", NumberOrNull(size.half_width_now)},
                     {"half_width_then", NumberOrNull(size.half_width_then)}});
  for (const UntriedEffect& nuisance : outcome.untried)
    untried.push_back({{"nuisance", nuisance.type}, {"why", nuisance.why}});
  return {{"name", outcome.name},
          {"what", outcome.what},
          {"seconds", outcome.seconds},
          {"message", outcome.message},
          {"named", named},
          {"probability", outcome.probability},
          {"pairs", pairs},
          {"sizes", sizes},
          {"protocol", PictureToJson(outcome.picture)},
          {"experiment", outcome.experiment},
          {"untried", untried}};
}

}  // namespace

double PlannedOutcome::LeastLambda() const {
  double least = std::numeric_limits<double>::infinity();
  for (const PlannedPair& pair : pairs) least = std::min(least, pair.lambda_then);
  return least;
}

void SortOutcomes(std::vector<PlannedOutcome>* outcomes) {
  const auto key = [](const PlannedOutcome& outcome) {
    return std::make_tuple(!outcome.IsPlayable(), -std::round(outcome.probability / kNoticeable),
                           outcome.seconds, -outcome.LeastLambda());
  };
  std::stable_sort(
      outcomes->begin(), outcomes->end(),
      [&](const PlannedOutcome& a, const PlannedOutcome& b) { return key(a) < key(b); });
}

bool IsPlanOf(const std::string& diagnosis, const std::filesystem::path& file) {
  const json plan = ReadJsonFile(file);
  return plan.is_object() && plan.value("diagnosis", json()) == diagnosis;
}

RecordVersion VersionOfPlan(const std::filesystem::path& file) {
  return VersionOf(ReadJsonFile(file), kSchemaVersion);
}

void WritePlanFile(const PlanRecord& record, const std::filesystem::path& file) {
  json rivals = json::array(), also_left = json::array(), outcomes = json::array();
  for (const PlannedRival& rival : record.rivals)
    rivals.push_back({{"effect", rival.effect},
                      {"effects", rival.effects},
                      {"title", rival.title},
                      {"probability", rival.probability},
                      {"of_diagnosis", rival.of_diagnosis},
                      {"named_now", rival.named_now}});
  for (const LeftNuisance& nuisance : record.also_left)
    also_left.push_back({{"nuisance", nuisance.name},
                         {"title", nuisance.title},
                         {"probability", nuisance.probability}});
  for (const PlannedOutcome& outcome : record.outcomes)
    outcomes.push_back(OutcomeToJson(outcome, record.rivals));
  const json all = {{"schema_version", kSchemaVersion},
                    {"diagnosis", record.diagnosis},
                    {"run", record.run},
                    {"verdict", record.verdict},
                    {"rivals", rivals},
                    {"no_effect", record.no_effect},
                    {"also_left", also_left},
                    {"not_predicted", record.not_predicted},
                    {"outcomes", outcomes}};
  WriteFileAtomically(file, all.dump(2) + "\n");
}

}  // namespace lacuna
