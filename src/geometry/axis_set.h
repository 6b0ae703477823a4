// A set of coordinate axes, such as those along which a part is held.
#ifndef LACUNA_GEOMETRY_AXIS_SET_H_
#define LACUNA_GEOMETRY_AXIS_SET_H_

#include <string>

namespace lacuna {

class AxisSet {
 public:
  constexpr AxisSet() = default;  // no axis
  static constexpr AxisSet All() { return AxisSet(7); }
  static constexpr AxisSet Of(int axis) { return AxisSet(1u << axis); }

  // `axis`: 0, 1 or 2 for x, y or z.
  constexpr bool Has(int axis) const { return ((bits_ >> axis) & 1u) != 0; }
  constexpr bool IsAll() const { return bits_ == 7; }
  constexpr bool IsEmpty() const { return bits_ == 0; }
  // Neither empty nor all.
  constexpr bool IsPartial() const { return !IsAll() && !IsEmpty(); }

  constexpr AxisSet operator|(AxisSet other) const { return AxisSet(bits_ | other.bits_); }
  constexpr AxisSet operator&(AxisSet other) const { return AxisSet(bits_ & other.bits_); }
  constexpr AxisSet Without(AxisSet other) const { return AxisSet(bits_ & ~other.bits_ & 7u); }
  constexpr bool operator==(const AxisSet&) const = default;

  // "x, z".
  std::string Names() const {
    std::string names;
    for (int axis = 0; axis < 3; ++axis)
      if (Has(axis)) names += (names.empty() ? "" : ", ") + std::string(1, "xyz"[axis]);
    return names;
  }

 private:
  constexpr explicit AxisSet(unsigned bits) : bits_(static_cast<unsigned char>(bits)) {}
  unsigned char bits_ = 0;
};

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_AXIS_SET_H_
