// What a run found, as plain data: read by the commands that compare, explain and report.
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

// NaN throughout means "not measured".
inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

// How the stage's solver ended, for one frame or for the whole stage.
struct SolverStatus {
  bool usable = false;
  std::string status = "not run";  // "converged", "no convergence", ...
  std::string message;
  int iterations = 0;
};

struct FrameRecord {
  int frame = 0;
  double time = kNotMeasured;  // s
  // |D| (Transue & Choi 2015, Eq. 1): the lengths of the alignment of the simulated surface with
  // the recorded one, summed over the points; then per point, so that frames with different numbers
  // of points compare, and that mean divided by RunRecord::object_size.
  double residual = kNotMeasured;       // m
  double residual_mean = kNotMeasured;  // m
  double relative_residual = kNotMeasured;
  // Distances of the recorded points from the simulated surface, m.
  double surface_distance_mean = kNotMeasured;
  double surface_distance_rms = kNotMeasured;
  double surface_distance_max = kNotMeasured;
  double relative_surface_distance = kNotMeasured;  // the mean, divided by object_size
  // Of the nodal forces, in N, and of their torques about the centre of mass, in N m.
  Eigen::Vector3d force_resultant = Eigen::Vector3d::Constant(kNotMeasured);
  // Standard deviation of the force resultant as the fit sees it; NaN where it was not a fit's
  // coefficients that made it.
  Eigen::Vector3d force_resultant_deviation = Eigen::Vector3d::Constant(kNotMeasured);
  Eigen::Vector3d torque_resultant = Eigen::Vector3d::Constant(kNotMeasured);
  SolverStatus solver;
};

struct MeshRecord {
  int64_t node_count = 0;
  int64_t tet_count = 0;
  int order = 0;                         // 0: no mesh
  double volume = kNotMeasured;          // m³
  double smallest_angle = kNotMeasured;  // dihedral, rad
  double largest_radius_edge_ratio = kNotMeasured;
};

struct RunRecord {
  std::string recording;              // its name
  double object_size = kNotMeasured;  // m, what relative measures refer to
  std::vector<FrameRecord> frames;
  double animation_residual = kNotMeasured;           // |D_anim| (Eq. 2): Σ |D|, m
  double relative_animation_residual = kNotMeasured;  // mean of the frames' relative residuals
  MeshRecord mesh;
  std::map<std::string, SolverStatus> stages;  // by stage
  std::map<std::string, double> measures;      // further named numbers, SI; the name says the unit
  std::vector<std::string> warnings;
  // Length of the residual displacement of each point of the simulated surface, points × frames, m;
  // 0 × 0 where not measured.
  Eigen::MatrixXd point_residuals;

  // Every stage and every frame has ended well.
  bool IsUsable() const;
};

// Writes into `folder`, which must exist: record.json with everything but the point residuals,
// point_residuals.npy with those, and frames.csv, the frames' numbers once more as a table.
// The point residuals' columns, if any, must be as many as the frames (CHECK).
void SaveRunRecord(const RunRecord& record, const std::filesystem::path& folder);

// Throws InputError when a file is absent or damaged.
RunRecord LoadRunRecord(const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_RECORD_RUN_RECORD_H_
