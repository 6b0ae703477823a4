// Forces and torques that load cells measure on the parts of the object that are held.
//
// The reaction of a held part is the force that the grip exerts on the object, in the coordinate
// system of the fixture: F = Σ r, with r = m a − f at the nodes of the part, their masses m,
// accelerations a and all other forces f on them; or the torque M = Σ (x − p) × r about a point p
// at rest (fem/grip_reaction.h). It is a result of the prediction and is compared with the reading,
// as markers and scans are.
#ifndef LACUNA_SCAN_MEASURED_REACTION_H_
#define LACUNA_SCAN_MEASURED_REACTION_H_

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config.h"
#include "core/quantity.h"
#include "geometry/axis_set.h"
#include "scan/data_location.h"

namespace lacuna {

inline constexpr Dimension kTorque{2, 1, -2, 0, 0, "a torque", "0.2 N m", "N m"};

struct MeasuredReaction {
  std::string name;                 // that of the held part
  size_t held = 0;                  // its number: the fixed regions, then the gripped ones
  std::vector<std::string> labels;  // c: "x", "y", "z", or "along"
  Eigen::Matrix3Xd directions;      // 3 × c, unit; component i of the reading is directions_i · F
  bool is_torque = false;           // a torque, N m in place of N
  // m, the point about which a torque is measured; absent: the mean of the undeformed nodes of the
  // held part.
  std::optional<Eigen::Vector3d> about;
  Eigen::VectorXd times;   // k, s, ascending
  Eigen::MatrixXd values;  // c × k, N
  double deviation = 0;    // N, σ of one value; 0: not given
  bool deviation_is_estimated = false;
  // N, prior standard deviation of an offset of each component that is the same at all times.
  double tare_deviation = 0;
  // s, prior standard deviation of the delay of the load cell's clock behind that of the frames;
  // 0: there is none.
  double delay_deviation = 0;
  // Whether the reading may also be that of the opposite force. Both signs are equally probable
  // before the data.
  bool sign_is_unknown = false;
  double time_margin = 0;  // s, by which a frame may lie before the first value or after the last
  std::filesystem::path file;
  std::string gaps;  // rows of the file that have no value or no time of their own; empty: none

  int Components() const { return static_cast<int>(directions.cols()); }
  const char* Unit() const { return is_torque ? "N m" : "N"; }
  const char* Quantity() const { return is_torque ? "torque" : "force"; }
  bool Covers(double time) const;
};

// The reading at a time that it covers (CHECKed), c × 1, N: linear between the measured times.
Eigen::VectorXd ReadingAt(const MeasuredReaction& reaction, double time);

// Reads `measured_force` and `measured_torque` of the items of `fixed` and `gripped`, whose names
// are `held`, in this order:
//   {file, time, time_unit, unit, x, y, z}       columns of one or more components, or
//   {file, time, time_unit, unit, along: [1, 0, 0], value}  the component in one direction
// and optionally `deviation`, `tare_deviation`, `delay_deviation`, `exerted_by: object` for a
// reading of the opposite force or `unknown`, and `about` for a torque. `frames` are all frames in
// the files. Throws InputError (file, line, column and field).
//   {from: headers, unit, …}                     values in the headers of the frame files
std::vector<MeasuredReaction> ReadReactions(const Config& config, const DataLocation& data,
                                            const FrameData& frames,
                                            const std::vector<std::string>& held,
                                            const std::vector<AxisSet>& axes);

// What `lacuna info` says about a reading.
std::string DescribeReaction(const MeasuredReaction& reaction);

// The reading as the entry `measured_force: {…}` or `measured_torque: {…}` in recording.yaml; its
// values go into the file reaction`number`.csv of `folder`.
std::string WriteReaction(const std::filesystem::path& folder, const MeasuredReaction& reaction,
                          size_t number);

}  // namespace lacuna

#endif  // LACUNA_SCAN_MEASURED_REACTION_H_
