// Whether the recordings of one fit agree about the parameters of the model, as plain data.
//
// Each recording has an estimate of its own, as if it had been fitted alone, but with the same
// error of mesh, step, shape, places, grips' markers and adopted nuisances as the others. The tests
// compare these estimates with the covariance of their differences (analysis/agreement.h).
#ifndef LACUNA_RECORD_AGREEMENT_RECORD_H_
#define LACUNA_RECORD_AGREEMENT_RECORD_H_

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace lacuna {

// Recordings disagree where agreement would be this improbable.
inline constexpr double kDisagreement = 0.05;

struct ParameterOfRecordings {
  std::string name, unit;
  // SI, one per recording; the standard deviation is infinite where the recording alone does not
  // determine the parameter.
  std::vector<double> values, deviations;
  // The probability of a difference at least as large by chance if this parameter is the only one
  // that may differ; 1 where the recordings do not determine the difference.
  double p_value = 1;
  // The recording that alone differs most; empty for fewer than three recordings.
  std::string odd_recording;
};

struct AgreementRecord {
  std::vector<std::string> recordings;  // those that were fitted; empty: fewer than two
  std::vector<ParameterOfRecordings> parameters;
  double chi_square = 0;
  int degrees_of_freedom = 0;  // 0: the recordings determine no difference
  double p_value = 1;          // of all parameters together

  bool Exists() const { return degrees_of_freedom > 0; }
  bool Disagree() const { return Exists() && p_value < kDisagreement; }
  // The parameter with the smallest p-value; null without parameters.
  const ParameterOfRecordings* MostDifferent() const;
};

nlohmann::json AgreementToJson(const AgreementRecord& agreement);
// Throws nlohmann::json::exception.
AgreementRecord AgreementFromJson(const nlohmann::json& value);

}  // namespace lacuna

#endif  // LACUNA_RECORD_AGREEMENT_RECORD_H_
