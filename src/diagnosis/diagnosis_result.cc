#include "diagnosis/diagnosis_result.h"

#include <glog/logging.h>

namespace lacuna {

std::string VerdictName(Diagnosis::Verdict verdict) {
  switch (verdict) {
    case Diagnosis::Verdict::kAdequate:
      return "adequate";
    case Diagnosis::Verdict::kMissing:
      return "missing";
    case Diagnosis::Verdict::kAmbiguous:
      return "ambiguous";
    case Diagnosis::Verdict::kNuisance:
      return "nuisance";
    case Diagnosis::Verdict::kNotInLibrary:
      return "not in library";
    case Diagnosis::Verdict::kNoPower:
      break;
  }
  return "no power";
}

}  // namespace lacuna
