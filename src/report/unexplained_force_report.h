// Describes the unexplained force in words.
#ifndef LACUNA_REPORT_UNEXPLAINED_FORCE_REPORT_H_
#define LACUNA_REPORT_UNEXPLAINED_FORCE_REPORT_H_

#include <string>

#include "record/unexplained_force_record.h"

namespace lacuna {

// A paragraph that begins with the recording's name: size, place, work and likely causes of the
// force, or why it could not be estimated.
std::string DescribeUnexplainedForce(const UnexplainedForceRecord& force,
                                     const std::string& recording);

}  // namespace lacuna

#endif  // LACUNA_REPORT_UNEXPLAINED_FORCE_REPORT_H_
