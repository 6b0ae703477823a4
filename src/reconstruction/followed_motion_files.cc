#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/json_file.h"
#include "core/json_number.h"
#include "core/npy.h"
#include "reconstruction/follow.h"
#include "reconstruction/reconstruction_study.h"

namespace lacuna {
namespace {

// NaN, which JSON does not have, is written as null.
nlohmann::json ToJson(const Eigen::Vector3d& v) {
  return v.hasNaN() ? nlohmann::json() : nlohmann::json{v.x(), v.y(), v.z()};
}
Eigen::Vector3d FromJson(const nlohmann::json& value) {
  if (value.is_null()) return Eigen::Vector3d::Constant(kNotMeasured);
  return Eigen::Vector3d(value.at(0).get<double>(), value.at(1).get<double>(),
                         value.at(2).get<double>());
}

}  // namespace

void WriteFollowedMotion(const FollowedMotion& motion, const std::filesystem::path& folder) {
  nlohmann::json index;
  index["noise_m"] = NumberOrNull(motion.noise);
  index["warnings"] = motion.warnings;
  for (size_t k = 0; k < motion.frames.size(); ++k) {
    const FollowedFrame& frame = motion.frames[k];
    index["frames"].push_back({{"time_s", frame.time},
                               {"weighted_rms", frame.weighted_rms},
                               {"observations", frame.observations},
                               {"force_deviation_N", ToJson(frame.force_deviation)},
                               {"residual_problem", frame.residual_problem},
                               {"usable", frame.solver.usable},
                               {"status", frame.solver.status},
                               {"message", frame.solver.message},
                               {"iterations", frame.solver.iterations}});
    WriteNpy(folder / fmt::format("position_{:04}.npy", k), frame.position);
    WriteNpy(folder / fmt::format("force_{:04}.npy", k), frame.force);
    WriteNpy(folder / fmt::format("pseudo_force_{:04}.npy", k), frame.pseudo_force);
    WriteNpy(folder / fmt::format("residual_{:04}.npy", k), frame.residual);
  }
  WriteFileAtomically(folder / "motion.json", index.dump(2) + "\n");
}

FollowedMotion ReadFollowedMotion(const ReconstructionStudy& study, const ReferenceBody& reference,
                                  const std::filesystem::path& folder) {
  return ReadJsonFile(folder / "motion.json", [&](const nlohmann::json& index) {
    FollowedMotion motion;
    motion.body = std::make_shared<Body>(MakeBody(reference.mesh, study.density));
    motion.noise = NumberOr(index.at("noise_m"));
    motion.warnings = index.at("warnings");
    for (const nlohmann::json& entry : index.at("frames")) {
      FollowedFrame frame;
      frame.time = entry.at("time_s");
      frame.weighted_rms = entry.at("weighted_rms");
      frame.observations = entry.at("observations");
      frame.force_deviation = FromJson(entry.at("force_deviation_N"));
      frame.residual_problem = entry.at("residual_problem");
      frame.solver = {entry.at("usable"), entry.at("status"), entry.at("message"),
                      entry.at("iterations")};
      const size_t k = motion.frames.size();
      frame.position = ReadNpyMatrix(folder / fmt::format("position_{:04}.npy", k));
      frame.force = ReadNpyMatrix(folder / fmt::format("force_{:04}.npy", k));
      frame.pseudo_force = ReadNpyMatrix(folder / fmt::format("pseudo_force_{:04}.npy", k));
      frame.residual = ReadNpyMatrix(folder / fmt::format("residual_{:04}.npy", k));
      motion.frames.push_back(std::move(frame));
    }
    return motion;
  });
}

}  // namespace lacuna
