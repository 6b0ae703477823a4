#include "scan/recorded_object.h"

#include <fmt/format.h>

#include <utility>

#include "scan/path_doubts.h"
#include "scan/time_span.h"

namespace lacuna {
namespace {

// `Object` is RecordedObject or const RecordedObject.
template <typename Object>
auto PointersToRegions(Object* object) {
  std::vector<decltype(&object->grips.front().region)> regions;
  for (auto& support : object->fixed) regions.push_back(&support.region);
  for (auto& grip : object->grips) regions.push_back(&grip.region);
  for (auto& force : object->forces)
    if (force.region) regions.push_back(&*force.region);
  return regions;
}

}  // namespace

std::vector<RecordedSupport> ReadSupports(const Config& config, const DataLocation& data) {
  std::vector<RecordedSupport> supports;
  for (const Config& item : config.Items("fixed")) {
    const std::string name = fmt::format("fixed {}", supports.size() + 1);
    RecordedSupport support{ReadRegion(item, data.folder, name), ReadDirections(item)};
    support.placement = ReadPlacement(item, support.axes);
    supports.push_back(std::move(support));
  }
  return supports;
}

std::string DescribeSupport(const RecordedSupport& support) {
  const std::string text = support.region.name + ": " + DescribeRegion(support.region);
  return support.axes.IsAll() ? text : text + ", along " + support.axes.Names() + " only";
}

std::string WriteSupport(const RecordedSupport& support) {
  return WithPlacement(WithDirections(FormatRegion(support.region), support.axes),
                       support.placement);
}

std::vector<const Region*> RegionsIn(const RecordedObject& object) {
  return PointersToRegions(&object);
}

std::vector<Region*> RegionsIn(RecordedObject* object) { return PointersToRegions(object); }

std::vector<std::filesystem::path> FilesOf(const RecordedObject& object) {
  std::vector<std::filesystem::path> files;
  const auto add = [&](const std::filesystem::path& file) {
    if (!file.empty()) files.push_back(file);
  };
  for (const Region* region : RegionsIn(object))
    if (const auto* listed = std::get_if<NodeRegion>(&region->shape)) add(listed->file.file);
  for (const RecordedGrip& grip : object.grips) add(grip.file);
  for (const MeasuredForce& force : object.forces) add(force.file);
  for (const MeasuredReaction& reaction : object.reactions) add(reaction.file);
  return files;
}

std::vector<std::string> HeldParts(const RecordedObject& object) {
  std::vector<std::string> names;
  for (const RecordedSupport& support : object.fixed) names.push_back(support.region.name);
  for (const RecordedGrip& grip : object.grips) names.push_back(grip.region.name);
  return names;
}

std::vector<AxisSet> HeldAxesOfParts(const RecordedObject& object) {
  std::vector<AxisSet> axes;
  for (const RecordedSupport& support : object.fixed) axes.push_back(support.axes);
  for (const RecordedGrip& grip : object.grips) axes.push_back(grip.axes);
  return axes;
}

std::vector<PlacementDeviation> PlacementDeviationsOfParts(const RecordedObject& object) {
  std::vector<PlacementDeviation> placements;
  for (const RecordedSupport& support : object.fixed) placements.push_back(support.placement);
  for (const RecordedGrip& grip : object.grips) placements.push_back(grip.placement);
  return placements;
}

std::vector<std::string> DoubtsOfObject(const RecordedObject& object, double first, double last) {
  std::vector<std::string> doubts;
  if (object.density) {
    const std::string doubt = DoubtOfDensity(*object.density);
    if (!doubt.empty()) doubts.push_back(doubt);
  }
  const auto add = [&](const std::string& name, const std::filesystem::path& file,
                       const std::string& doubt) {
    if (!doubt.empty()) doubts.push_back(fmt::format("{} ({}): {}", name, file.string(), doubt));
  };
  const auto check = [&](const std::string& name, const std::filesystem::path& file,
                         const Eigen::VectorXd& times,
                         const Eigen::Ref<const Eigen::MatrixXd>& values) {
    if (!file.empty()) add(name, file, DoubtOfTimeSpan(times, values, first, last));
  };
  for (const RecordedGrip& grip : object.grips) {
    if (grip.motion != GripMotion::kGiven) continue;
    const std::string name = "the path of " + grip.region.name;
    check(name, grip.file, grip.times, grip.displacements);
    add(name, grip.file, DoubtOfTurn(grip));
    add(name, grip.file, DoubtOfGap(grip, first, last));
  }
  for (const MeasuredForce& force : object.forces) {
    check("the force " + force.name, force.file, force.times, force.forces);
  }
  for (const MeasuredReaction& reaction : object.reactions) {
    check(fmt::format("the {} on {}", reaction.Quantity(), reaction.name), reaction.file,
          reaction.times, reaction.values);
  }
  return doubts;
}

std::vector<std::string> DoubtsOfJumps(const RecordedObject& object, double size, double last) {
  std::vector<std::string> doubts;
  for (const RecordedGrip& grip : object.grips) {
    if (grip.motion != GripMotion::kGiven) continue;
    const std::string doubt = DoubtOfJump(grip, size, last);
    if (!doubt.empty())
      doubts.push_back(
          fmt::format("the path of {} ({}): {}", grip.region.name, grip.file.string(), doubt));
  }
  return doubts;
}

std::string DoubtOfDensity(double density) {
  constexpr double kAir = 1.2, kLightest = 4 * kAir, kHeaviest = 23000;  // kg/m³; osmium: 22590
  if (density >= kLightest && density <= kHeaviest) return "";
  if (density > kHeaviest)
    return fmt::format("a density of {:g} kg/m³ is above that of all metals", density);
  return fmt::format(
      "a density of {:g} kg/m³ is like that of air ({} kg/m³); 1 g/cm^3 is 1000 kg/m^3", density,
      kAir);
}

}  // namespace lacuna
