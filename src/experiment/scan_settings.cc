#include "experiment/scan_settings.h"

namespace lacuna {

FilterOptions ReadFilter(const Config& config) {
  FilterOptions filter;
  filter.outlier_neighbours = config.Integer("outlier_neighbours", 0, 1000, 16);
  filter.outlier_deviations =
      config.Number("outlier_deviations", kPositive, filter.outlier_deviations);
  filter.voxel_size = config.Quantity("voxel", kLength, kNotNegative, filter.voxel_size);
  filter.normal_neighbours = config.Integer("normal_neighbours", 3, 1000, filter.normal_neighbours);
  return filter;
}

SurfaceOptions ReadSurface(const Config& config) {
  SurfaceOptions surface;
  surface.depth = config.Integer("depth", 0, 12, surface.depth);
  surface.samples_per_node = config.Number("samples_per_node", kPositive, surface.samples_per_node);
  surface.point_weight = config.Number("point_weight", kNotNegative, surface.point_weight);
  surface.edge_length = config.Quantity("edge_length", kLength, kNotNegative, surface.edge_length);
  return surface;
}

ScanSettings ReadScanSettings(const Config& config) {
  ScanSettings settings;
  const auto scan = config.OptionalChild("scan");
  if (!scan) return settings;
  if (const auto filter = scan->OptionalChild("filter")) settings.filter = ReadFilter(*filter);
  if (const auto surface = scan->OptionalChild("surface")) settings.surface = ReadSurface(*surface);
  settings.patches = scan->Integer("patches", 10, 100000, settings.patches);
  settings.points = scan->Integer("points", 100, 10000000, settings.points);
  settings.reach = scan->Number("reach", {0, 1, true, false}, settings.reach);
  settings.noise = scan->Quantity("noise", kLength, kNotNegative, settings.noise);
  settings.shape_deviation =
      scan->Quantity("shape_deviation", kLength, kNotNegative, settings.shape_deviation);
  return settings;
}

}  // namespace lacuna
