// A known outer force: a dead weight, a load cell's reading, the load of a synthetic scene.
#ifndef LACUNA_FEM_PRESCRIBED_FORCE_H_
#define LACUNA_FEM_PRESCRIBED_FORCE_H_

#include <Eigen/Core>
#include <functional>

#include "fem/cloneable_effect.h"

namespace lacuna {

// Share of each node (n, sum 1) in a force that acts evenly on the boundary between `nodes`: the
// work-equivalent one, ∝ ∫ N_a dA, on faces whose nodes are all chosen (of quadratic ones on the
// midpoints alone), a third of a triangle each on what else they span; where they span none, in
// proportion to the boundary area around them. CHECKs that there is any.
Eigen::VectorXd BoundaryShares(const Body& body, const Eigen::VectorXi& nodes);

// f_i = gain · share_i · F(t), in fixed directions. The gain is 1 for a gauge that tells the truth.
class PrescribedForce final : public CloneableEffect<PrescribedForce> {
 public:
  // `share`: n; `force`: F(t), N.
  PrescribedForce(Eigen::VectorXd share, std::function<Eigen::Vector3d(double time)> force);

  const EffectCard& Card() const override;
  Eigen::VectorXd Parameters() const override { return Eigen::VectorXd::Constant(1, gain_); }
  void SetParameters(const Eigen::VectorXd& values) { gain_ = values[0]; }

  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override;
  void AddTangents(const Kinematics&, const TangentWeights&, bool, BlockMatrix*) const override {}
  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override;
  std::optional<double> Energy(const Kinematics& at) const override;

 private:
  Eigen::VectorXd share_;
  std::function<Eigen::Vector3d(double)> force_;
  double gain_ = 1;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_PRESCRIBED_FORCE_H_
