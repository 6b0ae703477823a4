// What differs between the configurations of several runs, and whether their errors may be
// compared.
#ifndef LACUNA_REPORT_RUN_DIFFERENCES_H_
#define LACUNA_REPORT_RUN_DIFFERENCES_H_

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "record/manifest.h"

namespace lacuna {

// The frames of one recording to which a run's errors refer.
struct MeasuredSpan {
  std::string recording;
  std::string unit;  // what is measured: "markers", "scans"
  int fitted_frames = 0, held_out_frames = 0;
};

// A run as the comparison sees it.
struct ComparableRun {
  std::string name;
  Manifest manifest;
  std::vector<MeasuredSpan> spans;
};

// Throws InputError, which names two runs and what does not match, unless all runs have the same
// recordings with the same content, measure the same and have the same fitted and held-out frames.
void RefuseOtherMetrics(const std::vector<ComparableRun>& runs);

// The values of the configurations, in SI units, that are not the same in all runs:
// [{"key": "material.young_modulus", "values": ["120000", "200000"]}, ...]. A key that a run lacks
// has the value "".
nlohmann::json ConfigurationDifferences(const std::vector<ComparableRun>& runs);

}  // namespace lacuna

#endif  // LACUNA_REPORT_RUN_DIFFERENCES_H_
