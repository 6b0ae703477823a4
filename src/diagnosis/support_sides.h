// The sides of a body against which a support may lie.
#ifndef LACUNA_DIAGNOSIS_SUPPORT_SIDES_H_
#define LACUNA_DIAGNOSIS_SUPPORT_SIDES_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fem/body.h"

namespace lacuna {

// The part of the surface at rest that faces along a coordinate axis, without gripped nodes.
struct BodySide {
  std::string name;                                  // "−z"
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // outward, along a coordinate axis
  // The coordinate axes within the side: the longer direction first.
  int longer = 0, shorter = 0;
  Eigen::Vector3d low, high;  // m, the extent of the side

  double Length() const { return high[longer] - low[longer]; }
  double Width() const { return high[shorter] - low[shorter]; }
};

// The sides that are not gripped, at most six. `gripped`: one flag per node; empty: none.
std::vector<BodySide> SidesOf(const Body& body, const std::vector<char>& gripped);

// The point of the side at this coordinate along its longer direction: in the middle of its shorter
// one, at the mean height of the surface within about `reach` (m).
Eigen::Vector3d PlaceOn(const BodySide& side, double along, double reach, const Body& body);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_SUPPORT_SIDES_H_
