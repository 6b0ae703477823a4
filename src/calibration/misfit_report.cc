#include "calibration/misfit_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "geometry/nearest.h"

namespace lacuna {
namespace {

// The most markers of a recording that are told one by one.
constexpr size_t kMostTold = 6;
// A prior is strained where the fit is so many of its deviations away.
constexpr double kStrained = 3;
// A frame of a scan is worth a word where fewer of its points were compared, in parts of the
// best's.
constexpr double kFewestCompared = 0.85;

void AddMarkerStrains(const PredictionStudy& study, const RecordingMisfit& misfit,
                      const Recording& recording, std::vector<std::string>* strains) {
  if (!misfit.has_own_places) return;
  const std::vector<std::string>& names = recording.markers.names;
  const Eigen::RowVectorXd away = misfit.place_offset.colwise().norm();
  std::vector<int> strained;
  for (int m = 0; m < away.size(); ++m)
    if (away[m] > kStrained * study.place_deviation) strained.push_back(m);
  std::stable_sort(strained.begin(), strained.end(),
                   [&](int a, int b) { return away[a] > away[b]; });
  for (size_t k = 0; k < strained.size() && k < kMostTold; ++k) {
    const Eigen::Vector3d offset = 1e3 * misfit.place_offset.col(strained[k]);
    strains->push_back(
        fmt::format("{}: the model would have marker {} ({:.2g}, {:.2g}, {:.2g}) mm from where "
                    "it is on the undeformed object; place_deviation allows {:.2g} mm",
                    misfit.name, names[strained[k]], offset[0], offset[1], offset[2],
                    1e3 * study.place_deviation));
  }
  if (strained.size() > kMostTold)
    strains->push_back(fmt::format("{}: so it would {} of its {} markers, these the most",
                                   misfit.name, strained.size(), away.size()));
}

// Where tracked points sit is read off the first frame, where the object must be undeformed: points
// that lie beside a given shape say that it is not, or that shape and points do not fit together.
void AddTrackedStrains(const PredictionStudy& study, const PredictedRecording& item,
                       const Body& body, std::vector<std::string>* strains) {
  const Recording& recording = item.recording;
  if (!HasTrackedPoints(recording) || recording.reference.source == ReferenceSource::kFirstFrame)
    return;
  const Eigen::VectorXd away =
      SurfaceSearch(body.boundary.surface).Nearest(recording.markers.places).distance;
  const double rms = std::sqrt(away.squaredNorm() / static_cast<double>(away.size()));
  if (rms > kStrained * study.place_deviation)
    strains->push_back(fmt::format(
        "{}: in frame {}, which must show the object undeformed, tracked points lie {:.2g} mm "
        "(rms) beside the reference shape; place_deviation allows {:.2g} mm",
        item.name, item.frames.front(), 1e3 * rms, 1e3 * study.place_deviation));
}

void AddScanStrains(const ScanSettings& scan, const RecordingMisfit& misfit,
                    const RecordingModel& model, std::vector<std::string>* strains) {
  const auto strained =
      (misfit.place_offset.array().abs() > kStrained * scan.shape_deviation).count();
  if (strained > 0)
    strains->push_back(fmt::format(
        "{}: {} of {} patches lie off the model's surface in all frames alike, by up to {:.1f} mm; "
        "scan.shape_deviation allows {:.1f} mm",
        misfit.name, strained, misfit.place_offset.cols(),
        1e3 * misfit.place_offset.cwiseAbs().maxCoeff(), 1e3 * scan.shape_deviation));
  const std::vector<int> lost = model.LostFrames(misfit.misfit, kFewestCompared);
  if (!lost.empty())
    strains->push_back(fmt::format(
        "{}: in {} of {} frames, the first at {:.3f} s, fewer than {:.0f} % as many scanned "
        "points as in the best one are within scan.reach of the predicted surface; the rest was "
        "not compared",
        misfit.name, lost.size(), misfit.misfit.frames.size(),
        model.item().recording.times[lost.front()], 100 * kFewestCompared));
}

}  // namespace

CsvTable MisfitTable(const CalibrationProblem& problem,
                     const std::vector<RecordingMisfit>& misfits) {
  std::vector<std::vector<double>> columns(11);
  for (size_t r = 0; r < misfits.size(); ++r) {
    const RecordingMisfit& recording = misfits[r];
    const RecordingModel& model = problem.models()[r];
    const Misfit& misfit = recording.misfit;
    const Eigen::VectorXd residual = misfit.ResidualWithout(recording.place_offset);
    for (size_t f = 0; f < misfit.frames.size(); ++f) {
      const int frame = misfit.frames[f];
      const Observed& observed = misfit.observed[f];
      for (int m = 0; m < misfit.points; ++m) {
        const Eigen::Index at = static_cast<Eigen::Index>(f) * misfit.points + m;
        const Eigen::Vector3d measured = observed.measured.col(m);
        Eigen::Vector3d difference = Eigen::Vector3d::Constant(kNotMeasured);
        if (misfit.count[at] > 0 && misfit.Components() == 3)
          difference = residual.segment<3>(3 * at);
        if (misfit.count[at] > 0 && misfit.Components() == 1)
          difference = residual[at] * observed.normal.col(m);
        const double row[] = {static_cast<double>(r),
                              static_cast<double>(frame),
                              model.item().recording.times[frame],
                              static_cast<double>(m),
                              static_cast<double>(recording.fitted[f]),
                              measured[0],
                              measured[1],
                              measured[2],
                              difference[0],
                              difference[1],
                              difference[2]};
        for (size_t k = 0; k < columns.size(); ++k) columns[k].push_back(row[k]);
      }
    }
  }
  const char* names[] = {"recording",      "frame",          "time_s",        "marker",
                         "fitted",         "measured_x_m",   "measured_y_m",  "measured_z_m",
                         "difference_x_m", "difference_y_m", "difference_z_m"};
  CsvTable table;
  for (size_t k = 0; k < columns.size(); ++k)
    table.push_back(
        {names[k], Eigen::Map<Eigen::VectorXd>(columns[k].data(),
                                               static_cast<Eigen::Index>(columns[k].size()))});
  return table;
}

std::vector<std::string> Strains(const CalibrationProblem& problem,
                                 const std::vector<RecordingMisfit>& misfits) {
  std::vector<std::string> strains;
  const PredictionStudy& study = problem.study();
  for (size_t r = 0; r < misfits.size(); ++r) {
    const auto& own = problem.models()[r].nuisances();
    for (size_t k = 0; k < own.size() && misfits[r].nuisance.size() > 0; ++k) {
      const CalibratedParameter& prior = own[k].prior;
      const double away =
          std::abs(misfits[r].nuisance[static_cast<Eigen::Index>(k)]) / prior.prior_deviation;
      if (away > kStrained)
        strains.push_back(
            fmt::format("{} is {:.1f} deviations of its prior away from 0", prior.name, away));
    }
    if (study.recordings[r].scans != nullptr) {
      AddScanStrains(study.scan, misfits[r], problem.models()[r], &strains);
    } else {
      AddMarkerStrains(study, misfits[r], study.recordings[r].recording, &strains);
      AddTrackedStrains(study, study.recordings[r], *problem.body(), &strains);
    }
  }
  return strains;
}

FittedScan DescribeScan(const RecordingMisfit& misfit, const Eigen::Matrix3Xd& places,
                        double noise) {
  FittedScan scan;
  scan.places = places;
  double offered = 0, used = 0, variances = 0;
  int seen = 0;
  for (const Observed& observed : misfit.misfit.observed) {
    offered += observed.offered;
    used += observed.used;
  }
  for (const int count : misfit.misfit.count) {
    if (count == 0) continue;
    variances += noise * noise / count;
    ++seen;
  }
  if (offered > 0) scan.used = used / offered;
  if (seen > 0) scan.patch_noise = std::sqrt(variances / seen);
  return scan;
}

}  // namespace lacuna
