// The fitted model of a run of `lacuna fit`, as one of its recordings sees it, for export.
#ifndef LACUNA_EXCHANGE_DESCRIBED_RUN_H_
#define LACUNA_EXCHANGE_DESCRIBED_RUN_H_

#include <Eigen/Core>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "exchange/portable_model.h"
#include "fem/model.h"
#include "fem/prediction.h"

namespace lacuna {

struct DescribedRun {
  PortableModel model;
  // What PredictPositions predicts the motion with.
  Model source;
  PredictionOptions prediction;
};

struct DescribedRunOptions {
  std::string recording;  // its name; empty: the first one of the run
  // s, recorded time: later frames are left out.
  double until = std::numeric_limits<double>::infinity();
};

// Opens the run and describes the model at the fitted values of its parameters and of the nuisance
// parameters of the recording: the force of a hold, and the delay of the clock, by which frames are
// shifted. The registration of the recording is not part of the model. Throws InputError as OpenRun
// and FramesUntil do, and where no recording has that name.
DescribedRun DescribeRun(const std::filesystem::path& run, const DescribedRunOptions& options);

// The frames until the recorded time `until`, s, on the model's clock: `times`, s, ascending, minus
// `delay`. Throws InputError where frames show the motion, which begins at `start` on the model's
// clock, but none of them is left.
std::vector<double> FramesUntil(double until, const std::vector<double>& times, double delay,
                                double start);

// The positions (3n × frames, m) that Lacuna predicts at PortableModel::frames, preceded by the
// equilibrium at the start of the motion: 1 + frames columns. Throws InputError where the
// prediction stops early; Interrupted.
Eigen::MatrixXd PredictPositions(const DescribedRun& run);

}  // namespace lacuna

#endif  // LACUNA_EXCHANGE_DESCRIBED_RUN_H_
