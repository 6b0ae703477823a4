// Do the intervals of a fit contain the truth as often as they say?
//
// Simulation-based calibration (Talts, Betancourt, Simpson, Vehtari & Gelman, Validating Bayesian
// inference algorithms with simulation-based calibration, arXiv:1804.06788): parameters are drawn
// from their prior within the bounds of their cards, a recording is simulated with them, and the
// model is fitted to it. The position of the truth in the posterior of the fit,
//   u = Φ((φ_true − φ_centre) / s),
// with the centre and the standard deviation s that the 95 % interval implies, is distributed
// uniformly over all draws if the intervals are right. φ is the parameter or its logarithm.
//
// The truth has finer elements, a shorter time step, other dimensions and displaced markers, as in
// a sealed case (trials/trial_case.h). An effect may be part of the truth and of the model, so that
// its parameters are fitted, or of the truth alone: then the intervals are those of a wrong model.
#ifndef LACUNA_TRIALS_INTERVAL_TRIALS_H_
#define LACUNA_TRIALS_INTERVAL_TRIALS_H_

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/config.h"
#include "record/calibration_record.h"
#include "trials/trial_case.h"

namespace lacuna {

struct IntervalSuite {
  uint64_t seed = 0;
  int draws = 0;
  int recordings = 1;            // of each draw, 1 or 2
  double element_volume = 4e-7;  // m³, of the model
  // The volume of the model's elements over that of the truth's. The intervals are those of
  // infinitely fine elements, so that what is left of the model's error in the truth looks like a
  // bias.
  double finer_truth = 20;
  double true_step = 1e-3;                 // s, time step of the truth
  double noise = TrialCase{}.noise;        // m, standard deviation of a marker's coordinate
  std::vector<std::string> modelled = {};  // effects of the truth and of the model
  std::vector<std::string> missing = {};   // effects of the truth alone
  std::vector<TrialPrior> priors = {};     // of parameters of the model and of missing effects
};
// Throws InputError at the key that is wrong. Every parameter of an effect that defines its size
// must have a prior; the others without one are as in the sealed cases, and known.
IntervalSuite ReadIntervalSuite(const Config& config);

// Draw `number` of the suite; it depends on the suite's seed and this number alone. A true value
// outside the bounds of its card, which the fit cannot reach, is drawn again. Throws InputError if
// a prior has hardly any probability between the bounds.
TrialCase DrawIntervalCase(const IntervalSuite& suite, int number);

// A fitted parameter whose true value is known.
struct JudgedParameter {
  std::string name, unit;
  double truth = 0;          // SI
  double value = 0;          // as fitted, SI
  double low = 0, high = 0;  // 95 % interval, SI
  double deviations = 0;     // (φ_true − φ_centre) / s
};
// The parameters of the fit that are drawn in the case; those of the recordings are left out.
std::vector<JudgedParameter> Judge(const CalibrationRecord& record, const TrialCase& truth);

// What the draws say of one parameter.
struct IntervalTally {
  std::string name;
  int draws = 0;
  double covered_50 = 0, covered_80 = 0, covered_95 = 0;  // share of draws
  double mean = 0, spread = 0;    // of JudgedParameter::deviations; 0 and 1 where all is right
  double p_uniform = 1;           // χ² test of u in ten bins of equal width
  std::vector<double> positions;  // u, ascending
};

struct IntervalReport {
  std::vector<IntervalTally> tallies;
  std::vector<std::string> failed;   // draws that cannot be simulated or have no usable fit, and
                                     // why
  std::vector<std::string> missing;  // effects that the truth has and the model lacks
};

// Makes and fits the draws of the suite that have no intervals.json in the folder yet: see WorkOn
// (trials/case_files.h).
bool RunIntervalSuite(const IntervalSuite& suite, const std::filesystem::path& folder, int workers);
// Throws InputError if a file cannot be read.
IntervalReport ReportIntervals(const std::filesystem::path& folder);
std::string IntervalReportInWords(const IntervalReport& report);
// Writes intervals.txt, intervals.json and intervals.svg: for each parameter, the share of draws
// whose truth lies below the p-quantile of its posterior, over p.
void WriteIntervalReport(const IntervalReport& report, const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_INTERVAL_TRIALS_H_
