// The results of a run as plain data, read by the commands that compare, explain and report.
#ifndef LACUNA_RECORD_RUN_RECORD_H_
#define LACUNA_RECORD_RUN_RECORD_H_

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace lacuna {

// The value of a measure that does not exist. Test for it with std::isnan.
inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

// How the solver of a stage ended, for one frame or for the whole stage.
struct SolverStatus {
  bool usable = false;
  std::string status = "not run";  // "converged", "no convergence", ...
  std::string message;
  int iterations = 0;
};

struct FrameRecord {
  int frame = 0;
  double time = kNotMeasured;  // s
  // |D| (Transue & Choi 2015, Eq. 1): the sum over the points of the simulated surface of their
  // distances from the corresponding recorded points or, where tracked points identify themselves,
  // the sum over those that are seen of their distances from their places on the model; the mean
  // per point, which makes frames with different numbers of points comparable; and that mean
  // divided by RunRecord::object_size.
  double residual = kNotMeasured;       // m
  double residual_mean = kNotMeasured;  // m
  double relative_residual = kNotMeasured;
  // Distances of the recorded points from the simulated surface, m.
  double surface_distance_mean = kNotMeasured;
  double surface_distance_rms = kNotMeasured;
  double surface_distance_max = kNotMeasured;
  double relative_surface_distance = kNotMeasured;  // the mean divided by object_size
  // The sum of the nodal forces, N, and its standard deviation, N; the latter is NaN unless the
  // forces were fitted.
  Eigen::Vector3d force_resultant = Eigen::Vector3d::Constant(kNotMeasured);
  Eigen::Vector3d force_resultant_deviation = Eigen::Vector3d::Constant(kNotMeasured);
  // The sum of the torques of the nodal forces about the centre of mass, N m.
  Eigen::Vector3d torque_resultant = Eigen::Vector3d::Constant(kNotMeasured);
  SolverStatus solver;
};

struct MeshRecord {
  int64_t node_count = 0;
  int64_t tet_count = 0;
  int order = 0;                         // order of the elements; 0 if there is no mesh
  double volume = kNotMeasured;          // m³
  double smallest_angle = kNotMeasured;  // rad, smallest dihedral angle
  double largest_radius_edge_ratio = kNotMeasured;
};

// The external forces under which the model followed the recording.
enum class RunForces { kNone, kKnown, kFitted };

struct RunRecord {
  std::string recording;              // the name of the recording
  double object_size = kNotMeasured;  // m, the length to which relative measures refer
  RunForces forces = RunForces::kFitted;
  std::vector<FrameRecord> frames;  // those that were tried; the last one need not be usable
  int frames_not_tried = 0;         // that were to be followed after the last of `frames`
  double animation_residual = kNotMeasured;           // |D_anim| (Eq. 2): Σ |D|, m
  double relative_animation_residual = kNotMeasured;  // mean of the frames' relative residuals
  MeshRecord mesh;
  std::map<std::string, SolverStatus> stages;  // by name of the stage
  std::map<std::string, double> measures;      // further numbers, SI; the name ends with the unit
  std::vector<std::string> warnings;
  // The length of the residual displacement of each point of the simulated surface or, where they
  // identify themselves, of each tracked point: points × frames, m; 0 × 0 if not measured.
  Eigen::MatrixXd point_residuals;

  // The number of frames that were to be followed.
  int FrameCount() const { return static_cast<int>(frames.size()) + frames_not_tried; }
  // Whether there are frames, all were tried, and all frames and stages are usable.
  bool IsUsable() const;
};

// Writes three files into `folder`, which must exist: record.json with everything except the point
// residuals, point_residuals.npy with those, and frames.csv, a table of the numbers of the frames.
// Throws InputError if a file cannot be written. CHECKs that the point residuals, if any, have one
// column per frame.
void WriteRunRecord(const RunRecord& record, const std::filesystem::path& folder);

// Reads record.json and point_residuals.npy. Throws InputError if a file is absent or damaged.
RunRecord ReadRunRecord(const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_RECORD_RUN_RECORD_H_
