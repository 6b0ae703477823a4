// Reads the parts of a YAML file that say how scans are cleaned and compared with a model.
#ifndef LACUNA_EXPERIMENT_SCAN_SETTINGS_H_
#define LACUNA_EXPERIMENT_SCAN_SETTINGS_H_

#include <nlohmann/json.hpp>

#include "core/config.h"
#include "scan/filter.h"
#include "surface/reconstruct.h"

namespace lacuna {

// Reads `filter: {outlier_neighbours: 16, …}`.
FilterOptions ReadFilter(const Config& config);
// Reads `surface: {depth: 0, …}`.
SurfaceOptions ReadSurface(const Config& config);

// How the scans of a prediction study are compared with its model.
struct ScanSettings {
  FilterOptions filter;
  SurfaceOptions surface;  // for a reference shape that is itself a scan
  // The number of patches into which the model's surface is divided; each gives one measurement per
  // frame. More: finer detail, but each patch is noisier, and the fit is slower.
  int patches = 150;
  // The number of points used in each frame, drawn uniformly at random. More: slower, less noise.
  int points = 5000;
  // Scanned points farther than this from the predicted surface do not belong to the object, as a
  // fraction of the object's size. Larger: worse start values are tolerated, and more points of
  // other objects are used.
  double reach = 0.1;
  double noise = 0;  // m, σ of a scanned point along the normal; 0: estimated from the scans
  // m, σ of the model's undeformed surface: up to this size, an error of a patch that is the same
  // in all frames is attributed to the shape. Larger: only changes of the shape affect the fit.
  double shape_deviation = 5e-4;
};

// Reads `scan: {…}`; without it the settings are the defaults.
ScanSettings ReadScanSettings(const Config& config);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_SCAN_SETTINGS_H_
