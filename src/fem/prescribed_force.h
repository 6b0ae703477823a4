// A known external load with a fixed distribution over the boundary: a dead weight, the reading of
// a load cell, or the load of a synthetic scene.
#ifndef LACUNA_FEM_PRESCRIBED_FORCE_H_
#define LACUNA_FEM_PRESCRIBED_FORCE_H_

#include <Eigen/Core>
#include <functional>

#include "fem/cloneable_effect.h"

namespace lacuna {

// The share of each node (n, sum 1) in a uniform traction on the part of the boundary that `nodes`
// span. On faces of which all nodes are listed the shares are work-equivalent, ∝ ∫ N_a dA (0 at the
// corners of a quadratic face). On other triangles that the nodes span each corner receives a third
// of the area. If the nodes span no triangle, the shares are proportional to the boundary area of
// each node. CHECKs that this area is positive.
Eigen::VectorXd BoundaryShares(const Body& body, const Eigen::VectorXi& nodes);

// f_i = gain · share_i · F(t), with a direction that does not follow the body. The parameter
// `gain`, true force per measured force, is 1 for a correct force sensor.
class PrescribedForce final : public CloneableEffect<PrescribedForce> {
 public:
  // `share` has n entries; `force` is F(t) in N for a time in s, and may be called from any thread.
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
