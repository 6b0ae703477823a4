#include "diagnosis/recording_agreement.h"

#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "analysis/agreement.h"

namespace lacuna {
namespace {

// Whether the markers of another fitted recording sit where those of `r` do.
bool SharesMarkers(const CalibrationProblem& problem, size_t r) {
  if (problem.models()[r].PointCount() > kMostSharedMarkers) return false;
  for (size_t other = 0; other < problem.models().size(); ++other)
    if (other != r && problem.models()[other].recording().fitted && problem.ShareMarkers(r, other))
      return true;
  return false;
}

// The errors of the markers' places as columns: for each place, in each of its rows the deformation
// gradient of the frame. Recordings with the same markers have the same columns.
struct PlaceColumns {
  Eigen::MatrixXd columns;
  std::vector<LinearPrior> priors;
};

PlaceColumns ColumnsOfPlaces(const CalibrationProblem& problem, LinearisedMisfit* misfit) {
  const auto shares = [&](const LinearisedMisfit::Part& part) {
    return part.IsOfPoints() && part.errors.common != 0 && SharesMarkers(problem, part.recording);
  };
  PlaceColumns errors;
  std::map<int, Eigen::Index> first_column;  // of each place
  for (const LinearisedMisfit::Part& part : misfit->parts) {
    if (!shares(part)) continue;
    for (const int place : problem.PlaceIds(part.recording))
      if (first_column.try_emplace(place, 3 * std::ssize(first_column)).second)
        errors.priors.insert(errors.priors.end(), 3, {0, part.errors.common, false});
  }
  errors.columns.setZero(misfit->residual.size(), std::ssize(errors.priors));
  for (LinearisedMisfit::Part& part : misfit->parts) {
    if (!shares(part)) continue;
    const std::vector<int>& places = problem.PlaceIds(part.recording);
    for (size_t at = 0; at < part.layout.deformation.size(); ++at) {
      if (part.layout.count[3 * at] == 0) continue;
      const Eigen::Index row = part.first_row + 3 * static_cast<Eigen::Index>(at);
      errors.columns.block<3, 3>(row, first_column.at(places[at % places.size()])) =
          part.layout.deformation[at];
    }
    part.errors.common = 0;
  }
  return errors;
}

// A change of a parameter, in its own unit, that would matter to the user.
Eigen::VectorXd TypicalChanges(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                               Eigen::Index of_model) {
  Eigen::VectorXd typical(of_model);
  for (Eigen::Index k = 0; k < of_model; ++k) {
    const CalibratedParameter& parameter = problem.parameters()[static_cast<size_t>(k)];
    typical[k] = parameter.typical * (parameter.log_scale ? values[k] : 1);
  }
  return typical;
}

// The columns of the problem's parameters that belong to this recording alone.
std::vector<Eigen::Index> OwnParameters(const CalibrationProblem& problem, size_t recording) {
  Eigen::Index next = static_cast<Eigen::Index>(problem.study().fitted.size());
  for (size_t r = 0; r < problem.models().size(); ++r) {
    if (!problem.models()[r].recording().fitted) continue;
    std::vector<Eigen::Index> own;
    for (size_t k = 0; k < problem.models()[r].nuisances().size(); ++k) own.push_back(next++);
    if (r == recording) return own;
  }
  return {};
}

}  // namespace

AgreementRecord CompareRecordings(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                                  const LinearisedMisfit& misfit, const AdoptedNuisances& shared,
                                  const NoiseLevel& noise, double model_error) {
  AgreementRecord record;
  const Eigen::Index of_model = static_cast<Eigen::Index>(problem.study().fitted.size());
  std::vector<size_t> fitted;
  for (size_t r = 0; r < problem.models().size(); ++r)
    if (problem.models()[r].recording().fitted) fitted.push_back(r);
  if (fitted.size() < 2 || of_model == 0) return record;

  LinearisedMisfit independent;  // whose points have errors of their places of their own, if any
  independent.residual = misfit.residual;
  independent.parts = misfit.parts;
  for (LinearisedMisfit::Part& part : independent.parts) part.layout.offset_ids.clear();
  const PlaceColumns places = ColumnsOfPlaces(problem, &independent);
  const auto whiten = [&](const Eigen::MatrixXd& rows) {
    return WhitenedRows(rows, independent,
                        {.correlation_time = noise.correlation_time, .fitted_only = true});
  };
  const Eigen::VectorXd residual = whiten(independent.residual);
  const Eigen::MatrixXd parameters =
      whiten(misfit.jacobian.leftCols(static_cast<Eigen::Index>(problem.parameters().size())));
  Eigen::MatrixXd shared_columns(residual.size(), shared.columns.cols() + places.columns.cols());
  shared_columns << shared.columns, places.columns;
  shared_columns = whiten(shared_columns);
  std::vector<LinearPrior> shared_priors = shared.priors;
  shared_priors.insert(shared_priors.end(), places.priors.begin(), places.priors.end());
  const std::vector<LinearPrior> priors = PriorsAbout(problem.parameters(), values);

  std::vector<RecordingRows> recordings;
  for (const size_t r : fitted) {
    std::vector<Eigen::Index> rows;
    for (const LinearisedMisfit::Part& part : independent.parts)
      if (part.recording == r)
        for (Eigen::Index row = 0; row < part.layout.Rows(); ++row)
          rows.push_back(part.first_row + row);
    const std::vector<Eigen::Index> own = OwnParameters(problem, r);
    RecordingRows& recording = recordings.emplace_back();
    recording.residual = residual(rows);
    recording.parameters = parameters.leftCols(of_model)(rows, Eigen::all);
    recording.own = parameters(rows, own);
    for (const Eigen::Index column : own)
      recording.own_priors.push_back(priors[static_cast<size_t>(column)]);
    recording.shared = shared_columns(rows, Eigen::all);
    record.recordings.push_back(problem.models()[r].recording().name);
  }
  const AgreementTest test =
      TestAgreement(recordings, shared_priors, TypicalChanges(problem, values, of_model),
                    noise.variance, std::sqrt(2 * model_error));
  record.chi_square = test.chi_square;
  record.degrees_of_freedom = test.degrees_of_freedom;
  record.p_value = test.p_value;
  for (Eigen::Index k = 0; k < of_model; ++k) {
    const CalibratedParameter& prior = problem.parameters()[static_cast<size_t>(k)];
    ParameterOfRecordings parameter;
    parameter.name = prior.name;
    parameter.unit = problem.UnitOf(static_cast<size_t>(k));
    parameter.p_value = test.p_values[k];
    for (Eigen::Index i = 0; i < test.change.cols(); ++i) {
      const double change = test.change(k, i);
      const double factor = prior.log_scale ? std::exp(change / values[k]) : 1;
      parameter.values.push_back(prior.log_scale ? values[k] * factor : values[k] + change);
      parameter.deviations.push_back(test.deviation(k, i) * factor);
    }
    if (fitted.size() > 2) {
      Eigen::Index odd = 0;
      test.odd.row(k).maxCoeff(&odd);
      parameter.odd_recording = record.recordings[static_cast<size_t>(odd)];
    }
    record.parameters.push_back(std::move(parameter));
  }
  return record;
}

}  // namespace lacuna
