#include "prediction/simulated_cell.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace lacuna {
namespace {

// The number of the reading that an entry is about.
size_t ReadingOf(const Config& item, bool is_torque,
                 const std::vector<MeasuredReaction>& readings) {
  const std::string part = item.Text("part");
  const auto found =
      std::find_if(readings.begin(), readings.end(), [&](const MeasuredReaction& reading) {
        return reading.name == part && reading.is_torque == is_torque;
      });
  if (found == readings.end())
    item.Fail("part", fmt::format("the recording has no measured_{} of a part \"{}\"",
                                  is_torque ? "torque" : "force", part));
  return static_cast<size_t>(found - readings.begin());
}

}  // namespace

std::vector<SimulatedCell> ReadSimulatedCells(const Config& recording,
                                              const std::vector<MeasuredReaction>& readings) {
  constexpr double kRounding = 1e-9;  // relative, of a tare along a direction that is normalised
  if (!recording.Has("simulated_cells")) return {};
  std::vector<SimulatedCell> cells(readings.size());
  std::set<size_t> given;
  for (const Config& item : recording.Items("simulated_cells")) {
    const bool is_torque =
        item.Choice<bool>("measures", {{"force", false}, {"torque", true}}, "force");
    const size_t number = ReadingOf(item, is_torque, readings);
    if (!given.insert(number).second) item.Fail("part", "this load cell has an entry already");
    SimulatedCell& cell = cells[number];
    cell.tare = item.Vector("tare", is_torque ? kTorque : kForce, Eigen::Vector3d::Zero());
    cell.delay = item.Quantity("delay", kTime, kNotNegative, 0);
    const Eigen::Matrix3Xd& directions = readings[number].directions;
    const Eigen::Vector3d seen = directions * (directions.transpose() * cell.tare);
    if ((seen - cell.tare).norm() > kRounding * cell.tare.norm())
      item.Fail("tare", "has a component in a direction that the load cell does not measure");
  }
  return cells;
}

}  // namespace lacuna
