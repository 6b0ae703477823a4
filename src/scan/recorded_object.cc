#include "scan/recorded_object.h"

namespace lacuna {

std::vector<std::filesystem::path> FilesOf(const RecordedObject& object) {
  std::vector<std::filesystem::path> files;
  const auto add = [&](const std::filesystem::path& file) {
    if (!file.empty()) files.push_back(file);
  };
  const auto add_region = [&](const Region& region) {
    if (const auto* listed = std::get_if<NodeRegion>(&region.shape)) add(listed->file);
  };
  for (const Region& region : object.fixed) add_region(region);
  for (const RecordedGrip& grip : object.grips) {
    add_region(grip.region);
    add(grip.file);
  }
  for (const MeasuredForce& force : object.forces) {
    if (force.region) add_region(*force.region);
    add(force.file);
  }
  return files;
}

}  // namespace lacuna
