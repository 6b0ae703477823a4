// Where and how the object is gripped, as nuisances of a diagnosis.
#ifndef LACUNA_DIAGNOSIS_GRIP_NUISANCES_H_
#define LACUNA_DIAGNOSIS_GRIP_NUISANCES_H_

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/nuisance_candidates.h"

namespace lacuna {

// Directions to be simulated along the fitted motion (LinearisedMisfit::by): the placement of each
// grip (three shifts, three turns) and its compliance (it yields to its force, it turns with its
// moment). Compliance that comes out negative means a grip that reaches further than the model's.
class GripNuisances {
 public:
  explicit GripNuisances(const CalibrationProblem& problem);
  const std::vector<MisfitDirection>& directions() const { return directions_; }
  // `by`: the columns of directions(), after a run.
  std::vector<NuisanceCandidate> Candidates(const Eigen::MatrixXd& by) const;
  // What the noise of the markers that grips follow does, of quasi-static motions, where a frame's
  // errors end with it: each grip is shifted and turned by chance in every frame. None where no
  // grip follows markers, and of more frames than a few hundred.
  std::optional<NuisanceCandidate> Jitter(const CalibrationProblem& problem,
                                          const LinearisedMisfit& misfit,
                                          const Eigen::MatrixXd& by) const;

 private:
  // kStrain: what is gripped is stretched and sheared; for the jitter alone.
  enum class Of { kPlacement, kCompliance, kStrain };
  struct Kind {
    Of of = Of::kPlacement;
    std::string name, what, advice;
    size_t grip = 0;  // of the model
    int first = 0, count = 0;
    std::vector<std::shared_ptr<double>>
        largest;                    // motion seen, per direction; null: unit is known
    std::vector<double> deviation;  // prior, in the unit or in that motion
  };
  std::vector<MisfitDirection> directions_;
  std::vector<Kind> kinds_;
};

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_GRIP_NUISANCES_H_
