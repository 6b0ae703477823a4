#include "diagnosis/nuisance_catalogue.h"

#include <glog/logging.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "calibration/side_by_side.h"
#include "diagnosis/thresholds.h"

namespace lacuna {

NuisanceEntry MeshNuisance();
NuisanceEntry TimeStepNuisance();
NuisanceEntry ShapeNuisance();
NuisanceEntry GripJitterNuisance();
NuisanceEntry GripExtentNuisance();
NuisanceEntry LoadScaleNuisance();
NuisanceEntry RecordingsDifferNuisance();
NuisanceEntry GripPlacementNuisance();
NuisanceEntry GripComplianceNuisance();
NuisanceEntry ClockNuisance();
NuisanceEntry TimeJitterNuisance();
NuisanceEntry BadFrameNuisance();
NuisanceEntry RegistrationNuisance();
NuisanceEntry RegistrationDriftNuisance();

const std::vector<NuisanceEntry>& NuisanceCatalogue() {
  static const std::vector<NuisanceEntry> entries{
      // Nuisances of the model, all of which but the last three are part of every model.
      MeshNuisance(),
      TimeStepNuisance(),
      ShapeNuisance(),
      GripJitterNuisance(),
      GripExtentNuisance(),
      LoadScaleNuisance(),
      RecordingsDifferNuisance(),
      // Nuisances of each grip.
      GripPlacementNuisance(),
      GripComplianceNuisance(),
      // Nuisances of each recording.
      ClockNuisance(),
      TimeJitterNuisance(),
      BadFrameNuisance(),
      RegistrationNuisance(),
      RegistrationDriftNuisance(),
  };
  return entries;
}

namespace {

void Add(const NuisanceCard& card, NuisanceCandidate candidate,
         std::vector<NuisanceCandidate>* candidates) {
  candidate.card = card;
  if (candidate.what.empty()) candidate.what = card.title;
  candidates->push_back(std::move(candidate));
}

// Calls visit(card, maker) for the nuisances of one kind.
template <typename Maker, typename Visitor>
void ForEach(const Visitor& visit) {
  for (const NuisanceEntry& entry : NuisanceCatalogue())
    if (const Maker* make = std::get_if<Maker>(&entry.make)) visit(entry.card, *make);
}

}  // namespace

const NuisanceCard* FindNuisance(const std::string& name) {
  for (const NuisanceEntry& entry : NuisanceCatalogue())
    if (entry.card.name == name) return &entry.card;
  return nullptr;
}

std::vector<NuisanceTrial> NuisanceControls() {
  std::vector<NuisanceTrial> controls;
  for (const NuisanceEntry& entry : NuisanceCatalogue())
    if (entry.card.trial.control_position > 0) controls.push_back(entry.card.trial);
  std::sort(controls.begin(), controls.end(), [](const NuisanceTrial& a, const NuisanceTrial& b) {
    return a.control_position < b.control_position;
  });
  return controls;
}

namespace {

std::vector<NuisanceCandidate> Made(const std::vector<const NuisanceEntry*>& entries,
                                    const NuisanceContext& context,
                                    const std::vector<NuisanceCandidate>& known) {
  std::vector<std::optional<NuisanceCandidate>> made(entries.size());
  ForEachStudy(context.problem, static_cast<int64_t>(entries.size()), [&](int64_t k) {
    const size_t at = static_cast<size_t>(k);
    const auto same = std::find_if(known.begin(), known.end(), [&](const NuisanceCandidate& other) {
      return other.card.name == entries[at]->card.name && other.untried.empty();
    });
    made[at] = same != known.end() ? *same : std::get<ModelNuisance>(entries[at]->make)(context);
  });
  std::vector<NuisanceCandidate> candidates;
  for (size_t k = 0; k < entries.size(); ++k)
    if (made[k]) Add(entries[k]->card, *std::move(made[k]), &candidates);
  return candidates;
}

}  // namespace

std::vector<NuisanceCandidate> ModelNuisances(const NuisanceContext& context,
                                              const std::vector<NuisanceCandidate>& known) {
  std::vector<const NuisanceEntry*> entries;
  for (const NuisanceEntry& entry : NuisanceCatalogue())
    if (std::holds_alternative<ModelNuisance>(entry.make)) entries.push_back(&entry);
  return Made(entries, context, known);
}

std::optional<NuisanceCandidate> ModelNuisanceNamed(const std::string& name,
                                                    const NuisanceContext& context) {
  for (const NuisanceEntry& entry : NuisanceCatalogue()) {
    if (entry.card.name != name) continue;
    std::vector<NuisanceCandidate> made = Made({&entry}, context, {});
    return made.empty() ? std::nullopt : std::optional(std::move(made.front()));
  }
  LOG(FATAL) << "there is no nuisance " << name;
}

std::vector<NuisanceCandidate> SceneNuisances(const NuisanceContext& context) {
  std::vector<const NuisanceEntry*> entries;
  for (const NuisanceEntry& entry : NuisanceCatalogue())
    if (entry.card.is_shared_in_scene) entries.push_back(&entry);
  return Made(entries, context, {});
}

std::vector<NuisanceCandidate> NuisancesOfEveryModel(const NuisanceContext& context) {
  std::vector<const NuisanceEntry*> entries;
  for (const NuisanceEntry& entry : NuisanceCatalogue())
    if (entry.card.is_always_in_model) entries.push_back(&entry);
  return Made(entries, context, {});
}

std::vector<NuisanceCandidate> GripNuisances(const GripMotions& grips,
                                             const Eigen::MatrixXd& grip_columns) {
  std::vector<NuisanceCandidate> candidates;
  for (const GripMotions::Grip& grip : grips.grips)
    ForEach<GripNuisance>([&](const NuisanceCard& card, GripNuisance make) {
      Add(card, make(grip, grip_columns), &candidates);
    });
  return candidates;
}

std::vector<NuisanceCandidate> RecordingNuisances(const CalibrationProblem& problem,
                                                  const LinearisedMisfit& misfit,
                                                  const Eigen::VectorXd& whitened_residual) {
  const Eigen::Vector3d centre = problem.body()->mesh.nodes.rowwise().mean();
  std::vector<NuisanceCandidate> candidates;
  for (const LinearisedMisfit::Part& part : misfit.parts) {
    const std::vector<double>& times = part.layout.times;
    if (!part.IsOfPoints() || times.empty()) continue;
    const double spacing =
        (times.back() - times.front()) / std::max(1.0, static_cast<double>(times.size()) - 1);
    const RecordingContext context{problem, misfit, part, whitened_residual, spacing, centre};
    ForEach<RecordingNuisance>([&](const NuisanceCard& card, RecordingNuisance make) {
      if (std::ssize(times) < card.least_frames) return;
      if (auto candidate = make(context)) Add(card, *std::move(candidate), &candidates);
    });
  }
  return candidates;
}

NuisanceCandidate Untried(const NuisanceContext& context, const std::string& why) {
  NuisanceCandidate candidate;
  candidate.columns.resize(context.misfit.residual.size(), 0);
  candidate.untried = why;
  return candidate;
}

std::vector<LinearPrior> RigidMotionPriors() {
  const auto& thresholds = kThresholds.nuisances;
  std::vector<LinearPrior> priors(3, {0, thresholds.shift, false});
  priors.resize(6, {0, thresholds.rotation, false});
  return priors;
}

Eigen::VectorXd RecordingContext::Column(
    const std::function<double(Eigen::Index frame, int series)>& value) const {
  Eigen::VectorXd column = Eigen::VectorXd::Zero(misfit.residual.size());
  for (Eigen::Index frame = 0; frame < Frames(); ++frame)
    for (int series = 0; series < part.layout.series; ++series)
      column[part.first_row + frame * part.layout.series + series] = value(frame, series);
  return column;
}

Eigen::MatrixXd RecordingContext::RigidColumns(
    const std::function<double(Eigen::Index frame)>& share) const {
  Eigen::MatrixXd columns(misfit.residual.size(), 6);
  for (int axis = 0; axis < 6; ++axis)
    columns.col(axis) = Column([&](Eigen::Index frame, int series) {
      const Observed& seen = part.observed[static_cast<size_t>(frame)];
      const bool along_normal = seen.normal.cols() > 0;
      const int point = along_normal ? series : series / 3;
      if (seen.count[point] == 0) return 0.0;
      Eigen::Vector3d motion = Eigen::Vector3d::Unit(axis % 3);
      if (axis >= 3) motion = motion.cross(Eigen::Vector3d(seen.measured.col(point) - centre));
      return share(frame) *
             (along_normal ? motion.dot(seen.normal.col(point)) : motion[series % 3]);
    });
  return columns;
}

}  // namespace lacuna
