#include "calibration/misfit_report.h"

#include <cmath>

namespace lacuna {

CsvTable MisfitTable(const CalibrationProblem& problem,
                     const std::vector<RecordingMisfit>& misfits) {
  std::vector<std::vector<double>> columns(13);
  for (size_t r = 0; r < misfits.size(); ++r) {
    const RecordingMisfit& recording = misfits[r];
    const RecordingModel& model = problem.models()[r];
    const Misfit& misfit = recording.misfit;
    const Eigen::VectorXd residual = misfit.ResidualWithout(recording.place_offset);
    const double noise = problem.ErrorsOf(model).noise;
    for (size_t f = 0; f < misfit.frames.size(); ++f) {
      const int frame = misfit.frames[f];
      const Observed& observed = misfit.observed[f];
      for (int m = 0; m < misfit.points; ++m) {
        const Eigen::Index at = static_cast<Eigen::Index>(f) * misfit.points + m;
        const Eigen::Vector3d measured = observed.measured.col(m);
        Eigen::Vector3d difference = Eigen::Vector3d::Constant(kNotMeasured);
        double along_normal = kNotMeasured, sigma = kNotMeasured;
        if (misfit.count[at] > 0) {
          sigma = noise / std::sqrt(misfit.count[at]);
          if (misfit.Components() == 3) {
            difference = residual.segment<3>(3 * at);
          } else {
            along_normal = residual[at];
            difference = along_normal * observed.normal.col(m);
          }
        }
        const double row[] = {static_cast<double>(r),
                              static_cast<double>(frame),
                              model.FrameTime(frame),
                              static_cast<double>(m),
                              static_cast<double>(recording.fitted[f]),
                              measured[0],
                              measured[1],
                              measured[2],
                              difference[0],
                              difference[1],
                              difference[2],
                              along_normal,
                              sigma};
        for (size_t k = 0; k < columns.size(); ++k) columns[k].push_back(row[k]);
      }
    }
  }
  const char* names[] = {"recording",      "frame",          "time_s",         "marker",
                         "fitted",         "measured_x_m",   "measured_y_m",   "measured_z_m",
                         "difference_x_m", "difference_y_m", "difference_z_m", "along_normal_m",
                         "sigma_m"};
  CsvTable table;
  for (size_t k = 0; k < columns.size(); ++k)
    table.push_back(
        {names[k], Eigen::Map<Eigen::VectorXd>(columns[k].data(),
                                               static_cast<Eigen::Index>(columns[k].size()))});
  return table;
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
  for (const double count : misfit.misfit.count) {
    if (count == 0) continue;
    variances += noise * noise / count;
    ++seen;
  }
  if (offered > 0) scan.used = used / offered;
  if (seen > 0) scan.patch_noise = std::sqrt(variances / seen);
  return scan;
}

}  // namespace lacuna
