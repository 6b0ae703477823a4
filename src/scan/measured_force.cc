#include "scan/measured_force.h"

#include <fmt/format.h>

#include "core/quoted_text.h"
#include "scan/time_series.h"
#include "scan/yaml_format.h"

namespace lacuna {

Eigen::Vector3d ForceAt(const MeasuredForce& force, double time) {
  return InterpolateLinearly(force.times, force.forces, time);
}

std::vector<MeasuredForce> ReadForces(const Config& config, const DataLocation& data,
                                      const FrameData& frames, double first_time) {
  std::vector<MeasuredForce> forces;
  for (const Config& item : config.Items("forces")) {
    MeasuredForce force;
    force.name = item.Text("name", fmt::format("force {}", forces.size() + 1));
    if (const auto region = item.OptionalChild("region")) {
      force.region = ReadRegion(*region, data.folder, force.name);
    }
    if (item.Has("constant")) {
      if (item.Has("file")) item.Fail("file", "the force is already given as a constant");
      force.forces = item.Vector("constant", kForce);
      force.times = Eigen::VectorXd::Constant(1, first_time);
    } else {
      const TimeSeries series = ReadVectorSeries(
          item, data, frames, ReadColumnUnit(item, "unit", kForce, "N"), Rows::kMeasured);
      force.file = series.table.file;
      force.times = series.times;
      force.forces = series.values;
      force.gaps = series.gaps;
    }
    forces.push_back(std::move(force));
  }
  return forces;
}

std::string DescribeForce(const MeasuredForce& force) {
  return fmt::format("{}: {} values, at most {:.4g} N{}{}", force.name, force.times.size(),
                     force.forces.colwise().norm().maxCoeff(),
                     force.region ? ", on " + DescribeRegion(*force.region) : "",
                     force.gaps.empty() ? "" : "; " + force.gaps);
}

std::string WriteForce(const std::filesystem::path& folder, const MeasuredForce& force,
                       size_t number) {
  std::string item = fmt::format("{{name: {}", QuotedText(force.name));
  if (force.times.size() == 1) {  // a table of one row would not cover the frames
    item += ", constant: " + FormatVector(force.forces.col(0), "N");
  } else {
    const std::string file = fmt::format("force{}.csv", number);
    WriteTimeSeries(folder / file, force.times, force.forces);
    item += fmt::format(", file: {}, time: time, x: x, y: y, z: z, unit: N", file);
  }
  if (force.region) item += ", region: " + FormatRegion(*force.region);
  return item + "}";
}

}  // namespace lacuna
