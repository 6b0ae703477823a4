// The space of a diagnosis joined by a planned recording, which has no measurements yet.
//
// The rows of the planned recording follow those of the run. With the columns A of the run and A_p
// of the planned recording, the products of both are AᵀA + A_pᵀA_p. The parameters of the model and
// the sizes of the effects are the same in both; the errors of the mesh, the step, the shape and
// the registration are taken to be new ones in the planned recording, which makes its predictions
// rather too cautious where they are the same.
#ifndef LACUNA_PLAN_JOINED_SPACE_H_
#define LACUNA_PLAN_JOINED_SPACE_H_

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/adequacy.h"
#include "diagnosis/hypothesis_space.h"
#include "diagnosis/recording_power.h"

namespace lacuna {

// `space` with the variants of these effects as its only hypotheses, after the columns of its base.
HypothesisSpace SpaceOfRivals(const HypothesisSpace& space, const std::vector<std::string>& rivals);

// The columns of a planned recording, whitened with its noise.
struct PlannedColumns {
  Eigen::MatrixXd parameters;  // rows × parameters of the model
  Eigen::MatrixXd own;         // rows × columns of a base that other recordings do not have
  std::vector<LinearPrior> own_priors;  // mean 0
  Eigen::MatrixXd variants;             // rows × columns of SpaceOfRivals() behind its base
};

class JoinedSpace {
 public:
  // `now`: a SpaceOfRivals(), in whose base the parameters of the model come first. Columns of a
  // joined space: the base of `now`, the planned recording's own ones, the variants.
  JoinedSpace(const HypothesisSpace& now, const PlannedColumns& planned);

  const HypothesisSpace& now() const { return now_; }
  const HypothesisSpace& joined() const { return joined_; }
  FoundEffect InJoined(FoundEffect found) const;  // of now(), with the columns of joined()

  // The products of the residual of both recordings, where the planned one is drawn at random as
  // it would be if the effect were missing, given what the recordings of the run say: the amounts
  // of the base and of the effect are drawn from their posterior, then the noise.
  Eigen::VectorXd DrawToward(const FoundEffect& truth, uint64_t seed, uint64_t number) const;

 private:
  HypothesisSpace now_, planned_, joined_;
  std::optional<NoiseDraws> noise_;  // of the planned recording
  Eigen::Index own_ = 0;
};

}  // namespace lacuna

#endif  // LACUNA_PLAN_JOINED_SPACE_H_
