// A comparison of a fitted model with its recordings, as a table and in words.
//
// Both are made from the record alone, so that a stored comparison (ReadComparisonFile) can be
// printed without the model.
#ifndef LACUNA_REPORT_COMPARISON_REPORT_H_
#define LACUNA_REPORT_COMPARISON_REPORT_H_

#include <string>
#include <vector>

#include "record/comparison_record.h"

namespace lacuna {

// One line for each recording and part, under a header; at most 100 columns for names of usual
// length. Every line ends with a line break.
std::string ComparisonTable(const ComparisonRecord& record);

// Paragraphs without line breaks. For each recording: its fitted and its held-out frames, its
// noise, and the unexplained force if it was computed; then the pairs of recordings.
std::vector<std::string> DescribeComparison(const ComparisonRecord& record);

}  // namespace lacuna

#endif  // LACUNA_REPORT_COMPARISON_REPORT_H_
