// Forces on the object that were measured while it was scanned.
#ifndef LACUNA_SCAN_MEASURED_FORCE_H_
#define LACUNA_SCAN_MEASURED_FORCE_H_

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config.h"
#include "scan/data_location.h"
#include "scan/region.h"

namespace lacuna {

struct MeasuredForce {
  std::string name;
  std::optional<Region> region;  // where it acts, if that is known
  Eigen::VectorXd times;         // k, s, ascending
  Eigen::Matrix3Xd forces;       // 3 × k, N, resultant, world frame
  std::filesystem::path file;    // file of the values; empty for a constant
  std::string gaps;              // rows of the file that have no value or no time of their own
};

// The force at a time, N: linear between the measured times, constant before the first and after
// the last.
Eigen::Vector3d ForceAt(const MeasuredForce& force, double time);

// Reads the items of `forces`: each either `constant: [..]`, or `file` (or `from: headers`) with
// the components of component_columns.h, of which those that are not named are 0, and the units of
// time_series.h; and optionally `name` and `region`. Without a named component, all three are read
// from columns with their usual names (ReadVectorSeries). `frames` are all frames in the files; a
// constant force gets `first_time` (s) as its only time. Throws InputError (file, line, column and
// field), also where a component is not named although the table has a column with its usual name.
std::vector<MeasuredForce> ReadForces(const Config& config, const DataLocation& data,
                                      const FrameData& frames, double first_time);

// What `lacuna info` says about a force.
std::string DescribeForce(const MeasuredForce& force);

// The force as an item of `forces` in recording.yaml; its values go into the file force`number`.csv
// of `folder`, a single value as `constant` into the item.
std::string WriteForce(const std::filesystem::path& folder, const MeasuredForce& force,
                       size_t number);

}  // namespace lacuna

#endif  // LACUNA_SCAN_MEASURED_FORCE_H_
