// The simulations behind Figure 1 (paper/drop_study.h), each of which is kept in a run folder.
#ifndef LACUNA_PAPER_DROP_RUN_H_
#define LACUNA_PAPER_DROP_RUN_H_

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/progress.h"
#include "fem/body.h"
#include "paper/drop_study.h"

namespace lacuna {

// The part of a simulated motion that is drawn.
struct DropMotion {
  std::shared_ptr<const Body> body;
  std::vector<double> times;                // s, one per frame
  std::vector<Eigen::Matrix3Xd> positions;  // 3 × nodes, m, one per frame
};

struct DropRun {
  DropMesh mesh;
  DropMotion motion;  // at the scene's steps
  DropNumbers numbers;
  DropNumbers halved;  // `numbers` with steps of half the length
};

// Runs all meshes one after the other. Each of the simulations is a stage of the run folder
// `folder` (record/run_directory.h): one that is found there is not repeated. Throws Interrupted,
// and InputError if a mesh cannot be made, a time step fails or the folder cannot be used.
std::vector<DropRun> RunDrop(const DropStudy& study, const std::filesystem::path& folder,
                             Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_PAPER_DROP_RUN_H_
