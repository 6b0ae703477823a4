#include "calibration/other_elements.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "core/error.h"
#include "meshing/tetrahedralize.h"
#include "prediction/predicted_body.h"

namespace lacuna {
namespace {

// Another mesh is one whose ratio is at least the wanted one to this power.
constexpr double kEnough = 0.5;
// A mesh with this many times more elements than wanted is made once more with larger ones.
constexpr double kTooMany = 1.5;

OtherElements Compared(const TetMesh& own, TetMesh other) {
  const double ratio = static_cast<double>(other.TetCount()) / static_cast<double>(own.TetCount());
  return {std::move(other), ratio};
}

bool IsEnough(const OtherElements& other, double wanted) {
  return std::log(other.ratio) / std::log(wanted) >= kEnough;
}

bool ListsNodes(const PredictionStudy& study) {
  return std::any_of(study.recordings.begin(), study.recordings.end(),
                     [](const PredictedRecording& item) {
                       const auto lists = [](const Region* region) {
                         return std::holds_alternative<NodeRegion>(region->shape);
                       };
                       const auto regions = RegionsIn(item.recording.object);
                       return std::any_of(regions.begin(), regions.end(), lists) ||
                              (item.hold && lists(&item.hold->region));
                     });
}

std::optional<OtherElements> MeshedAnew(const PredictionStudy& study, const TetMesh& own,
                                        double ratio) {
  if (study.recordings.front().recording.reference.source == ReferenceSource::kTetMesh)
    return std::nullopt;
  PredictionStudy other = study;
  other.mesh.tets.max_volume /= ratio;
  try {
    return Compared(own, MakeReferenceBody(other).mesh);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::optional<OtherElements> Divided(const PredictionStudy& study, const TetMesh& own,
                                     double ratio) {
  const TetMesh linear{own.nodes, own.tets.topRows(4)};
  const TriMesh surface = ExtractBoundary(linear).surface;
  TetOptions options = study.mesh.tets;
  options.preserve_surface = false;
  options.max_volume = TetVolumes(linear).maxCoeff() / ratio;
  for (bool again = true;; again = false) {
    const MeshResult meshed = MeshTetrahedra(surface, options);
    if (!meshed.IsUsable() || FindFlatTet(meshed.mesh) >= 0) return std::nullopt;
    OtherElements other = Compared(own, own.Order() == 2 ? ToQuadratic(meshed.mesh) : meshed.mesh);
    if (!again || other.ratio < kTooMany * ratio) return other;
    options.max_volume *= other.ratio / ratio;
  }
}

}  // namespace

std::optional<OtherElements> MeshWithOtherElements(const PredictionStudy& study, const TetMesh& own,
                                                   double ratio) {
  if (study.recordings.front().recording.reference.sheet_thickness > 0) return std::nullopt;
  if (auto other = MeshedAnew(study, own, ratio); other && IsEnough(*other, ratio)) return other;
  if (ratio < 1 || ListsNodes(study)) return std::nullopt;
  if (auto other = Divided(study, own, ratio); other && IsEnough(*other, ratio)) return other;
  return std::nullopt;
}

}  // namespace lacuna
