// How an instrument averages over the object.
#ifndef LACUNA_SCAN_INSTRUMENT_H_
#define LACUNA_SCAN_INSTRUMENT_H_

namespace lacuna {

// The subset of image correlation of which each tracked point or marker is the middle: a square on
// the surface, or a cube in volume correlation.
struct Instrument {
  double subset = 0;       // m, length of its edge; 0: the place of a point is that of a point
  bool is_volume = false;  // a cube, along the coordinate axes
};

}  // namespace lacuna

#endif  // LACUNA_SCAN_INSTRUMENT_H_
