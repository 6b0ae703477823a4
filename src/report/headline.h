// The story of a run in a few plain sentences, made from its records alone: how large the error is,
// what is missing, how certain that is, and what adding it did.
#ifndef LACUNA_REPORT_HEADLINE_H_
#define LACUNA_REPORT_HEADLINE_H_

#include <string>
#include <vector>

#include "report/reported_run.h"

namespace lacuna {

// For each of the models, at least one (CHECK): its error on the frames to which nothing was fitted
// (if nothing was held out, on the fitted ones), and the verdict of its diagnosis with what to do
// next. Where the first model was compared, the first sentence says where and when the error is
// largest. The verdict of the last model comes after a measured force that it misses by far more
// than the markers or scans, and a conflict with a prior of more than ten standard deviations.
std::vector<std::string> Headline(const std::vector<ReportedModel>& models);

}  // namespace lacuna

#endif  // LACUNA_REPORT_HEADLINE_H_
