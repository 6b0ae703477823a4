// A linearised misfit, and the form of it that linear evidence takes (analysis/linear_evidence.h):
// rows whitened by their noise, parameters with their priors.
#ifndef LACUNA_CALIBRATION_LINEAR_MISFIT_H_
#define LACUNA_CALIBRATION_LINEAR_MISFIT_H_

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "analysis/linear_evidence.h"
#include "analysis/measurement_errors.h"
#include "analysis/series_noise.h"
#include "experiment/observer.h"
#include "fit/calibration.h"

namespace lacuna {

// The misfit of the fitted recordings over all of their frames, held-out frames included, and its
// derivatives at some parameter values. The rows of the recordings follow one another; they are in
// m, those of reactions in N or N m, and not whitened.
struct LinearisedMisfit {
  // The points of one recording, or one of its measured reactions; the latter follow the former.
  struct Part {
    size_t recording = 0;            // its index in the study
    std::optional<size_t> reaction;  // its index in RecordingModel::Reactions(); none for points
    Eigen::Index first_row = 0;
    SeriesLayout layout;
    MeasurementErrors errors;
    std::vector<char> fitted;  // for each frame: 1 where it was fitted, 0 where held out
    Eigen::VectorXd speed;     // d(predicted)/dt, one entry per row, m/s or N/s
    double sign = 1;           // ReactionMisfit::sign
    // What the prediction was compared with, one entry per frame; empty for a reaction.
    std::vector<Observed> observed;
    Eigen::VectorXd held;  // 3n, m: the equilibrium before the motion

    bool IsOfPoints() const { return !reaction.has_value(); }
  };
  // The points of a recording (CHECKed to be there).
  const Part& PointsOf(size_t recording) const;

  bool usable = false;
  std::string message;
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;  // columns: the problem's parameters, then the directions asked for
  std::vector<Part> parts;
};

// The priors of the problem's parameters, expressed as changes from `values` in units of the
// parameter, also where a parameter is fitted on a logarithmic scale.
std::vector<LinearPrior> PriorsAbout(const std::vector<CalibratedParameter>& parameters,
                                     const Eigen::VectorXd& values);

// `values` changed by `change`, in the units of PriorsAbout(), and kept within the parameters'
// bounds. A parameter on a logarithmic scale is multiplied by the exponential of its relative
// change.
Eigen::VectorXd MovedBy(const std::vector<CalibratedParameter>& parameters,
                        const Eigen::VectorXd& values, const Eigen::VectorXd& change);

struct WhiteningOptions {
  double correlation_time = 0;  // s, of the noise; 0: white
  bool fitted_only = false;     // whether rows of frames that were not fitted become 0
};

// Rows of a linearised misfit, whitened with the measurement errors of their recordings. The error
// of a marker's place is common to the recordings that show the marker.
Eigen::MatrixXd WhitenedRows(const Eigen::MatrixXd& rows, const LinearisedMisfit& misfit,
                             const WhiteningOptions& options = {});

// The rows of the fitted frames, in the order of `rows`.
Eigen::MatrixXd FittedRows(const Eigen::MatrixXd& rows, const LinearisedMisfit& misfit);
// What a fit sees of a misfit: the whitened rows of its fitted frames.
ResidualEvaluation FittedEvaluation(const LinearisedMisfit& misfit);

// The noise level with which hypotheses are compared.
struct NoiseLevel {
  double correlation_time = 0;  // s
  double variance = 1;          // variance of the whitened rows
};

// The noise level that the residual `left` implies if all of it is noise: its correlation time,
// that of the points, and its variance, which is at least `least` times that of the study.
NoiseLevel LevelOf(const Eigen::VectorXd& left, const LinearisedMisfit& misfit,
                   Eigen::Index parameters, double least);

// The number of rows that were observed; `fitted_only`: in frames that were fitted.
Eigen::Index ObservedRows(const LinearisedMisfit& misfit, bool fitted_only = false);

// The rms over these rows of a residual (m, not whitened), over σ; 0 if there are none.
double RmsOverSigma(const Eigen::VectorXd& residual, const LinearisedMisfit& misfit,
                    bool fitted_only = false);

// The rms of the whitened rows that were observed and held out (of all rows where none were held
// out).
double HeldOutInNoise(const Eigen::VectorXd& whitened, const LinearisedMisfit& misfit);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_LINEAR_MISFIT_H_
