// The space of a diagnosis joined by a planned recording, which has no measurements yet.
//
// Let r and A be the residual and the columns of the run, r_p and A_p the same of the planned
// recording, and v the variance of the noise. The parameters of the model and the sizes of the
// effects are the same in both recordings. The errors of the mesh, the step, the shape, the grips
// and the hand that holds the object are taken to be new ones in the planned recording, with
// amounts from their priors, which makes its predictions rather too cautious where they are the
// same. With their columns B and their prior covariance P,
//   r_p + A_p δ ~ N(0, C),   C = v I + B P Bᵀ,
// so that the products of the planned recording, after the amounts of B have been integrated out
// (projected_hypotheses.h), are S = v A_pᵀC⁻¹A_p and v A_pᵀC⁻¹r_p, and those of both recordings
//   AᵀA + S   and   Aᵀr + v A_pᵀC⁻¹r_p.
#ifndef LACUNA_PLAN_JOINED_SPACE_H_
#define LACUNA_PLAN_JOINED_SPACE_H_

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "diagnosis/adequacy.h"
#include "diagnosis/hypothesis_space.h"
#include "diagnosis/recording_power.h"
#include "record/plan_record.h"

namespace lacuna {

// `space` with the variants of these effects as its only hypotheses, after the columns of its base.
HypothesisSpace SpaceOfEffects(const HypothesisSpace& space,
                               const std::vector<std::string>& effects);

// A SpaceOfEffects() with the rivals as its only hypotheses, which have the names of the rivals:
// each variant of a single effect, and for a pair each variant of the first effect with each of the
// second, whose columns are those of both. The columns of the space stay as they are.
HypothesisSpace SpaceOfRivals(const HypothesisSpace& effects,
                              const std::vector<PlannedRival>& rivals);

// The columns of a planned recording, whitened with its noise.
struct PlannedColumns {
  Eigen::MatrixXd parameters;  // rows × parameters of the model
  Eigen::MatrixXd own;         // rows × columns of a base that other recordings do not have
  std::vector<LinearPrior> own_priors;  // mean 0
  Eigen::MatrixXd variants;             // rows × columns of SpaceOfEffects() behind its base
};

class JoinedSpace {
 public:
  // `now`: a SpaceOfEffects() or SpaceOfRivals(), in whose base the parameters of the model come
  // first. CHECKs the sizes.
  JoinedSpace(const HypothesisSpace& now, const PlannedColumns& planned);

  // The base, the columns and the hypotheses of `now`, with the products of both recordings; the
  // residual is that of the run alone.
  const HypothesisSpace& joined() const { return joined_; }

  // Aᵀr + v A_pᵀC⁻¹r_p for a planned recording that is drawn at random as it would be if the effect
  // were missing, given what the recordings of the run say. The amounts δ of the base and of the
  // effect are drawn from their posterior, and those of B from their prior. The amounts that must
  // be positive are drawn first, together, from their posterior truncated at 0 (DrawPositive()),
  // and the others given them.
  //   v A_pᵀC⁻¹r_p = n − S δ,   n ~ N(0, v S).
  Eigen::VectorXd DrawToward(const FoundEffect& truth, uint64_t seed, uint64_t number) const;

 private:
  HypothesisSpace now_, planned_, joined_;
  NoiseDraws noise_;  // n
};

}  // namespace lacuna

#endif  // LACUNA_PLAN_JOINED_SPACE_H_
