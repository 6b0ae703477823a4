// The story of a reconstruction in a few plain sentences, made from its record alone.
#ifndef LACUNA_REPORT_RECONSTRUCTION_HEADLINE_H_
#define LACUNA_REPORT_RECONSTRUCTION_HEADLINE_H_

#include <string>
#include <vector>

#include "record/run_record.h"

namespace lacuna {

// How closely a reconstruction follows its recording, and what that says about the model.
std::vector<std::string> ReconstructionHeadline(const RunRecord& record);

}  // namespace lacuna

#endif  // LACUNA_REPORT_RECONSTRUCTION_HEADLINE_H_
