#include "calibration/size_errors.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "calibration/listed_nodes.h"
#include "calibration/side_by_side.h"
#include "core/error.h"
#include "core/parallel.h"

namespace lacuna {
namespace {

// The finite difference stretches the body by this share of the standard deviation: a larger change
// alters the phase of a long motion, which is not linear.
constexpr double kProbe = 0.1;

// Fitted recordings in which the object is stretched about the same point.
struct StretchedRecordings {
  Eigen::Vector3d centre;          // m
  std::vector<size_t> recordings;  // indices in the study, ascending
};

Eigen::Vector3d CentreOfStretch(const Model& model) {
  const Eigen::Matrix3Xd& nodes = model.body->mesh.nodes;
  if (model.grips.empty()) return nodes.rowwise().mean();
  return nodes(Eigen::all, model.grips.front().nodes).rowwise().mean();
}

std::vector<StretchedRecordings> ByCentre(const CalibrationProblem& problem) {
  std::vector<StretchedRecordings> groups;
  for (size_t r = 0; r < problem.models().size(); ++r) {
    if (!problem.models()[r].recording().fitted) continue;
    const Eigen::Vector3d centre = CentreOfStretch(problem.models()[r].model());
    auto group = std::find_if(groups.begin(), groups.end(), [&](const StretchedRecordings& other) {
      return other.centre == centre;
    });
    if (group == groups.end()) group = groups.insert(group, StretchedRecordings{centre, {}});
    group->recordings.push_back(r);
  }
  return groups;
}

bool IsOf(const StretchedRecordings& group, size_t recording) {
  return std::binary_search(group.recordings.begin(), group.recordings.end(), recording);
}

// The misfit of a group of recordings with the mesh stretched along an axis; nothing where it
// cannot be predicted. `listed`: the study with regions that keep their nodes. `options`: of the
// prediction.
std::optional<LinearisedMisfit> LineariseStretched(
    const StretchedRecordings& group, Eigen::Index axis, const CalibrationProblem& problem,
    const PredictionStudy& listed, const Eigen::VectorXd& values, const LineariseOptions& options) {
  TetMesh larger = problem.body()->mesh;
  larger.nodes.row(axis).array() +=
      kProbe * listed.size_deviation * (larger.nodes.row(axis).array() - group.centre[axis]);
  PredictionStudy study = listed;
  std::vector<double> own(values.data(), values.data() + study.fitted.size());
  for (size_t r = 0; r < study.recordings.size(); ++r) {
    study.recordings[r].fitted = IsOf(group, r);
    if (!study.recordings[r].fitted) continue;
    const Eigen::VectorXd nuisance = problem.NuisanceOf(r, values);
    own.insert(own.end(), nuisance.begin(), nuisance.end());
  }
  try {
    LinearisedMisfit changed =
        CalibrationProblem(study, larger)
            .Linearise(Eigen::Map<const Eigen::VectorXd>(own.data(),
                                                         static_cast<Eigen::Index>(own.size())),
                       options);
    if (changed.usable) return changed;
  } catch (const InputError&) {
    // For example, a grip that follows a scan loses it with the larger object.
  }
  return std::nullopt;
}

}  // namespace

Eigen::MatrixXd ChangesBySize(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                              const LinearisedMisfit& misfit,
                              const std::function<void()>& on_frame) {
  const Eigen::MatrixXd none(misfit.residual.size(), 0);
  if (problem.study().size_deviation == 0) return none;
  const PredictionStudy listed = WithListedNodes(problem);
  const std::vector<StretchedRecordings> groups = ByCentre(problem);
  Eigen::MatrixXd changes(misfit.residual.size(), 3);
  std::vector<char> is_usable(3 * groups.size(), 0);
  const auto change = [&](int64_t k) {
    const StretchedRecordings& group = groups[static_cast<size_t>(k / 3)];
    const Eigen::Index axis = k % 3;
    const std::optional<LinearisedMisfit> changed = LineariseStretched(
        group, axis, problem, listed, values, {.near = &misfit, .on_frame = on_frame});
    if (!changed) return;
    auto own = changed->parts.begin();
    for (const LinearisedMisfit::Part& part : misfit.parts) {
      if (!IsOf(group, part.recording)) continue;
      const Eigen::Index rows = part.layout.Rows();
      if (own == changed->parts.end() || own->layout.Rows() != rows) return;
      changes.col(axis).segment(part.first_row, rows) =
          (changed->residual.segment(own->first_row, rows) -
           misfit.residual.segment(part.first_row, rows)) /
          kProbe;
      ++own;
    }
    is_usable[static_cast<size_t>(k)] = 1;
  };
  const int64_t count = static_cast<int64_t>(is_usable.size());
  // Studies that predict one recording each have no loop over recordings to share among the threads
  // (side_by_side.h), so that they run side by side however many recordings the problem has.
  const bool has_one_each =
      std::all_of(groups.begin(), groups.end(),
                  [](const StretchedRecordings& group) { return group.recordings.size() == 1; });
  if (has_one_each)
    ParallelFor(count, 1, change);
  else
    ForEachStudy(problem, count, change);
  return std::count(is_usable.begin(), is_usable.end(), 0) == 0 ? changes : none;
}

}  // namespace lacuna
