// The known answers with which a reconstruction is compared. They do not enter the fit.
#ifndef LACUNA_RECONSTRUCTION_KNOWN_ANSWERS_H_
#define LACUNA_RECONSTRUCTION_KNOWN_ANSWERS_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/npy.h"
#include "geometry/tri_mesh.h"

namespace lacuna {

struct ValidationSettings {
  int hold_out_every = 0;                // hold out every k-th tracked point from the fit; 0: none
  std::filesystem::path true_surfaces;   // the truth/ folder of a virtual scan
  std::filesystem::path true_positions;  // .npy, frames × points × 3, m
  std::filesystem::path true_mesh;       // the tet mesh with these points as nodes
  std::filesystem::path true_forces;     // .npy, frames × 3, N, resultant force
};

// The true places of the nodes of a mesh over the frames of a recording.
struct TruePositions {
  Eigen::Matrix3Xd rest;  // 3 × n, m: the nodes of true_mesh that its tetrahedra use
  Eigen::VectorXi point;  // n, the point of `of_recording` at each node
  NpyArray of_recording;  // frames × points × 3, m
  Eigen::Matrix3Xd At(int frame) const;  // 3 × n, m
};

// These functions read the files that the settings name. They throw InputError, which names the
// file, where it cannot be read, has another shape than the settings describe, or lacks one of
// `frames` (numbers of the recording's frames) or a node of the mesh.
TruePositions ReadTruePositions(const ValidationSettings& validation,
                                const std::vector<int>& frames);
// Frames × 3, N.
Eigen::MatrixXd ReadTrueForces(const ValidationSettings& validation,
                               const std::vector<int>& frames);
TriMesh ReadTrueSurface(const ValidationSettings& validation, int frame);

// Throws InputError naming `file`, in which `points` (3 × n) were read as m, where they cannot be
// those of the object that a frame shows at `seen` (3 × n, m): their box, or the distance between
// the centres of both, is more than ten times as large. Millimetres would be a thousand times as
// large.
void RequireLengthUnit(const std::filesystem::path& file, const Eigen::Matrix3Xd& points,
                       const Eigen::Matrix3Xd& seen);

// All files that are read for these frames, each with a name for the manifest of a run.
std::vector<std::pair<std::string, std::filesystem::path>> FilesOfKnownAnswers(
    const ValidationSettings& validation, const std::vector<int>& frames);

}  // namespace lacuna

#endif  // LACUNA_RECONSTRUCTION_KNOWN_ANSWERS_H_
