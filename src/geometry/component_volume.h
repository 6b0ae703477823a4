// The volume of one closed component of a surface.
#ifndef LACUNA_GEOMETRY_COMPONENT_VOLUME_H_
#define LACUNA_GEOMETRY_COMPONENT_VOLUME_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace lacuna {

// Sums up the signed volume that closed triangles enclose, by the divergence theorem, and judges
// its sign. All lengths have one unit.
class ComponentVolume {
 public:
  // `box`: the bounding box of the component.
  explicit ComponentVolume(const Eigen::AlignedBox3d& box);

  // Adds a triangle by its corners, counter-clockwise seen from outside.
  void Add(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

  // Whether the volume is zero up to the rounding of the vertices' coordinates, as they stand in a
  // file: a shift of the triangles by it changes the volume by as much.
  bool IsFlat() const;
  // Whether the component is inside out: its volume is negative and it is not flat.
  bool IsNegative() const { return volume_ < 0 && !IsFlat(); }

 private:
  Eigen::Vector3d centre_;
  double largest_coordinate_;  // in magnitude
  double volume_ = 0, area_ = 0;
};

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_COMPONENT_VOLUME_H_
