// A program outside Lacuna's tree that uses its libraries: consumer EXPERIMENT
// Prints by how much a hanging bar stretches, in mm, and Young's modulus, in Pa, from a fit.
#include <cstdio>
#include <exception>
#include <memory>

#include "calibration/calibration_run.h"
#include "core/blas_kernels.h"
#include "effects/catalogue.h"
#include "fem/prediction.h"
#include "geometry/rounded_box.h"
#include "meshing/tetrahedralize.h"
#include "prediction/prediction_study_reader.h"

namespace {

constexpr double kLength = 0.2, kWidth = 0.02;          // m
constexpr double kDensity = 1000, kYoungModulus = 1e5;  // kg/m³, Pa

// The mean displacement, m, of the lower end of a bar that hangs from its upper end.
double Stretch() {
  lacuna::TetOptions meshing;
  meshing.order = 2;
  const lacuna::TriMesh surface =
      lacuna::RoundedBox({kLength / 2, 0, 0}, {kLength, kWidth, kWidth}, 0, kWidth / 2);
  const lacuna::MeshResult meshed = lacuna::MeshTetrahedra(surface, meshing);
  if (!meshed.IsUsable()) throw std::runtime_error(meshed.message);

  lacuna::Model model;
  model.body = std::make_shared<const lacuna::Body>(lacuna::MakeBody(meshed.mesh, kDensity));
  model.effects = {
      lacuna::MakeEffect("neo_hookean", {{"young_modulus", kYoungModulus}, {"poisson_ratio", 0}}),
      lacuna::MakeEffect("gravity",
                         {{"acceleration_x", 9.81}, {"acceleration_y", 0}, {"acceleration_z", 0}})};
  const lacuna::TetMesh& mesh = model.body->mesh;
  std::vector<int> upper, lower;
  for (int node = 0; node < mesh.NodeCount(); ++node) {
    if (mesh.nodes(0, node) < 1e-9) upper.push_back(node);
    if (mesh.nodes(0, node) > kLength - 1e-9) lower.push_back(node);
  }
  model.grips = {{Eigen::Map<Eigen::VectorXi>(upper.data(), static_cast<int>(upper.size())), {}}};

  lacuna::PredictionOptions options;
  options.step.scheme = lacuna::TimeScheme::kQuasiStatic;
  double stretch = 0;
  const lacuna::PredictionSummary summary =
      Predict(model, options, {0}, {}, [&](int, const lacuna::PredictedState& state) {
        for (const int node : lower)
          stretch += (state.position[3 * node] - kLength) / static_cast<double>(lower.size());
      });
  if (!summary.IsUsable()) throw std::runtime_error(summary.message);
  return stretch;
}

}  // namespace

int main(int argc, char** argv) {
  lacuna::UseFastBlasKernels(argv);  // those of the program, so that the result has the same bytes
  if (argc != 2) return 2;
  try {
    std::printf("stretch_mm %.4f\n", 1e3 * Stretch());
    lacuna::ProgressOptions silent;
    silent.style = lacuna::ProgressStyle::kSilent;
    lacuna::Progress progress(silent);
    const auto study = lacuna::ReadPredictionStudy(lacuna::Config::Load(argv[1]));
    const lacuna::CalibrationRecord record = lacuna::RunCalibration(study, &progress);
    std::printf("young_modulus_Pa %.1f\n", record.parameters.front().estimate.value);
    return record.usable ? 0 : 1;
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "consumer: %s\n", problem.what());
    return 1;
  }
}
