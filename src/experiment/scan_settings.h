// The parts of a YAML file that say how scans are cleaned and compared with a model.
#ifndef LACUNA_EXPERIMENT_SCAN_SETTINGS_H_
#define LACUNA_EXPERIMENT_SCAN_SETTINGS_H_

#include <nlohmann/json.hpp>

#include "core/config.h"
#include "scan/filter.h"
#include "surface/reconstruct.h"

namespace lacuna {

// `filter: {outlier_neighbours: 16, …}`
FilterOptions ReadFilter(const Config& config);
// `surface: {depth: 0, …}`
SurfaceOptions ReadSurface(const Config& config);

// How the scans of a prediction study are compared with its model.
struct ScanSettings {
  FilterOptions filter;
  SurfaceOptions surface;  // of a reference shape that is a scan
  // Into which the model's surface is divided; each makes one measurement a frame. More: finer
  // detail, each less certain, and a slower fit.
  int patches = 150;
  // Of each frame that are used, chosen evenly by chance. More: slower, less noise.
  int points = 5000;
  // Scanned points farther than this from the predicted surface are somebody else's, in parts of
  // the object's size. Larger: a worse start is forgiven, more foreign points are taken in.
  double reach = 0.1;
  double noise = 0;  // m, of a scanned point along the normal; 0: estimated from the scans
  // m, how well the model's undeformed surface is known: a patch's error that stays the same in all
  // frames is the shape's as far as this allows. Larger: only changes of the shape count.
  double shape_deviation = 5e-4;
};

// `scan: {…}`; absent: the defaults.
ScanSettings ReadScanSettings(const Config& config);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_SCAN_SETTINGS_H_
