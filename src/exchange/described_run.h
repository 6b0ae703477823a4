// The fitted model of a run of `lacuna fit`, as one of its recordings sees it, for export.
#ifndef LACUNA_EXCHANGE_DESCRIBED_RUN_H_
#define LACUNA_EXCHANGE_DESCRIBED_RUN_H_

#include <filesystem>
#include <limits>
#include <string>

#include "exchange/portable_model.h"
#include "prediction/predicted_motion.h"

namespace lacuna {

struct DescribedRun {
  PortableModel model;
  // The positions (3n × frames, m) that Lacuna predicts at PortableModel::frames, preceded by the
  // equilibrium at the start of the motion: 1 + frames columns. Empty unless asked for.
  Eigen::MatrixXd positions;
};

struct DescribedRunOptions {
  std::string recording;  // its name; empty: the first one of the run
  // s, recorded time: later frames are left out.
  double until = std::numeric_limits<double>::infinity();
  bool with_positions = false;  // predict the motion, too
};

// Opens the run and describes the model at the fitted values of its parameters and of the nuisance
// parameters of the recording: the force of a hold, and the delay of the clock, by which frames are
// shifted. The registration of the recording is not part of the model. Throws InputError as OpenRun
// does, where no recording has that name, and where the prediction stops early.
DescribedRun DescribeRun(const std::filesystem::path& run, const DescribedRunOptions& options);

}  // namespace lacuna

#endif  // LACUNA_EXCHANGE_DESCRIBED_RUN_H_
