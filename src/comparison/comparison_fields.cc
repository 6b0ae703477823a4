#include "comparison/comparison_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/atomic_file.h"
#include "fem/element_strain.h"
#include "fem/nodal_recovery.h"
#include "report/vtk_files.h"

namespace lacuna {
namespace {

// σ in turned coordinates, nine components row by row.
Eigen::MatrixXd TurnedTensors(const Eigen::MatrixXd& cauchy, const Eigen::Matrix3d& rotation) {
  Eigen::MatrixXd turned(9, cauchy.cols());
  for (Eigen::Index node = 0; node < cauchy.cols(); ++node) {
    const Eigen::Matrix<double, 6, 1> s = cauchy.col(node);
    const Eigen::Matrix3d tensor{{s[0], s[5], s[4]}, {s[5], s[1], s[3]}, {s[4], s[3], s[2]}};
    turned.col(node) = (rotation * tensor * rotation.transpose()).reshaped<Eigen::RowMajor>();
  }
  return turned;
}

void WriteBody(const Model& model, const TrajectoryState& state,
               const Eigen::Isometry3d& registration, const UnexplainedForce* force,
               double recorded_time, const std::filesystem::path& file) {
  const Body& body = *model.body;
  const Eigen::Matrix3Xd position = state.position.reshaped(3, body.NodeCount());
  const Eigen::Matrix3d& rotation = registration.linear();
  TetMesh deformed = body.mesh;
  deformed.nodes = registration * position;
  Eigen::RowVectorXd strain(body.ElementCount());
  for (int element = 0; element < body.ElementCount(); ++element)
    strain[element] =
        LargestPrincipal(MeanStrain(body, element, state.position, state.velocity).strain);
  const NodalStress stress =
      RecoverNodalStress(model, state.position, state.velocity, state.time, state.effect_state);
  FieldSet fields{{{"displacement_m", rotation * (position - body.mesh.nodes)},
                   {"velocity_m_per_s", rotation * state.velocity.reshaped(3, body.NodeCount())},
                   {"cauchy_stress_Pa", TurnedTensors(stress.cauchy, rotation)},
                   {"von_mises_stress_Pa", stress.von_mises.transpose()},
                   {"principal_stretches", stress.stretch}},
                  {{"strain", strain}}};
  if (force != nullptr)
    fields.nodes.push_back({"unexplained_force_N_per_m3",
                            rotation * force->field.DensityAt(recorded_time - force->delay)});
  WriteVtu(file, deformed, fields);
}

// The observed points of a frame: markers, or patches of a scanned surface.
void WritePoints(const RecordedResiduals& residuals, bool are_patches, int frame,
                 const Eigen::MatrixXd& over_noise, const std::filesystem::path& file) {
  std::vector<int> seen;
  for (int m = 0; m < residuals.PointCount(); ++m)
    if (residuals.difference.col(frame).segment<3>(3 * m).allFinite()) seen.push_back(m);
  const Eigen::Index count = static_cast<Eigen::Index>(seen.size());
  PointCloud cloud;
  cloud.points.resize(3, count);
  Eigen::MatrixXd difference(3, count), number(1, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    cloud.points.col(k) = residuals.measured.col(frame).segment<3>(3 * seen[k]);
    difference.col(k) = residuals.difference.col(frame).segment<3>(3 * seen[k]);
    number(0, k) = seen[k];
  }
  std::vector<Field> fields{
      {"predicted_m", cloud.points + difference},
      {"difference_m", difference},
      {"difference_over_sigma", over_noise.col(frame)(seen).transpose()},
      {"fitted", Eigen::MatrixXd::Constant(1, count, residuals.fitted[frame] != 0)},
      {are_patches ? "patch" : "marker", number}};
  if (are_patches)
    fields.push_back({"along_normal_m", residuals.along_normal.col(frame)(seen).transpose()});
  WriteVtp(file, cloud, fields);
}

}  // namespace

int WriteComparisonFields(const RecordingModel& model, const RecordedResiduals& residuals,
                          const ReplayedMotion& motion, const UnexplainedForce& force,
                          const Eigen::MatrixXd& over_noise, const std::filesystem::path& folder) {
  MakeFolder(folder / "fields");
  const auto file = [&](const char* what, int frame, const char* extension) {
    return folder / "fields" / fmt::format("{}_{:05}.{}", what, residuals.frames[frame], extension);
  };
  // The first state is the equilibrium before the motion. It is written for the last frame before
  // the motion, if there is one.
  const int first = motion.state_frame.front() < 0 ? 1 : 0;
  const int states = static_cast<int>(motion.states.size()) - first;
  const int count = std::min(states, kMostFieldFrames);
  const bool are_patches = model.recording().ShowsScans();
  const char* kind = are_patches ? "patches" : "markers";
  std::vector<TimedFile> bodies, points;
  for (int i = 0; i < count; ++i) {
    const int k = first + (count > 1 ? i * (states - 1) / (count - 1) : 0);
    const int frame = motion.state_frame[k];
    const double time = residuals.times[frame];
    WriteBody(model.model(), motion.states[k], motion.registration,
              force.record.usable ? &force : nullptr, time, file("body", frame, "vtu"));
    bodies.push_back({time, file("body", frame, "vtu")});
    WritePoints(residuals, are_patches, frame, over_noise, file(kind, frame, "vtp"));
    points.push_back({time, file(kind, frame, "vtp")});
  }
  WritePvd(folder / "body.pvd", bodies);
  WritePvd(folder / fmt::format("{}.pvd", kind), points);
  return static_cast<int>(bodies.size());
}

}  // namespace lacuna
