#include "report/unexplained_force_report.h"

#include <fmt/format.h>

#include <cmath>

#include "report/quantity_text.h"

namespace lacuna {
namespace {

// Thresholds for the sentences. Larger: fewer, more certain sentences.
constexpr double kNear = 0.35, kFar = 0.65;  // shares of the largest distance from the grip
constexpr double kMostlyConstant = 0.7;      // |mean| over rms
constexpr double kClearCorrelation = 0.7;
constexpr double kClearWork = 2;  // standard deviations

std::string Newtons(double force) { return fmt::format("{:.2g} N", force); }

std::string SizeText(const UnexplainedForceRecord& force) {
  const NetForceSummary& net = force.net;
  std::string text = fmt::format(
      "a smooth body force of {} rms ({:.2g} % of the weight of the moving part) would have made "
      "the model follow the recording. Its components are ",
      Newtons(net.rms.norm()), 100 * net.rms.norm() / net.weight);
  for (int axis = 0; axis < 3; ++axis)
    text += fmt::format("{}{:.2g} ± {:.1g} N in {}",
                        axis == 0   ? ""
                        : axis == 1 ? ", "
                                    : " and ",
                        net.rms[axis], net.rms_deviation[axis], "xyz"[axis]);
  return text +
         fmt::format(
             " (rms ± standard deviation). It would reduce the error over all frames from {:.1f} σ "
             "to {:.1f} σ.",
             force.fit.rms_over_sigma_without, force.fit.rms_over_sigma_with);
}

std::string PlaceText(const ForcePlace& place) {
  if (place.largest_grip_distance == 0) return "";
  const double share = place.grip_distance / place.largest_grip_distance;
  const char* where = share < kNear  ? "It acts near the grip"
                      : share > kFar ? "It acts mainly on the part far from the grip"
                                     : "It acts on the whole object or on its middle";
  return fmt::format(
      " {}: its centroid is {:.0f} mm away from the grip, and the object extends to {:.0f} mm.",
      where, 1e3 * place.grip_distance, 1e3 * place.largest_grip_distance);
}

std::string WorkText(const ForceWork& work) {
  std::string text = fmt::format(" In {:.2g} s it does {:.2g} ± {:.1g} mJ of work", work.duration,
                                 1e3 * work.work, 1e3 * work.deviation);
  if (std::abs(work.work) < kClearWork * work.deviation)
    return text + ", which is not significantly different from zero.";
  return text + fmt::format(" ({:.2g} mW on average): it {} the motion.", 1e3 * work.mean_power,
                            work.work > 0 ? "adds energy to" : "removes energy from");
}

// The likely cause of a force that is parallel or opposite to a quantity of the motion.
std::string SuggestionFor(const ForceCorrelation& entry) {
  const bool is_parallel = entry.correlation > 0;
  if (entry.quantity == "displacement")
    return is_parallel ? "the model is too stiff" : "the model is too soft";
  if (entry.quantity == "velocity")
    return is_parallel ? "the model has too much damping" : "the model lacks damping";
  return is_parallel ? "the model has too much mass" : "the model lacks mass";
}

std::string CauseText(const UnexplainedForceRecord& force) {
  std::string text;
  const bool is_constant = force.net.constant_share > kMostlyConstant;
  if (is_constant) {
    text += fmt::format(" It is mostly constant, {} toward {}, like a weight or a steady load.",
                        Newtons(force.net.mean.norm()), DirectionText(force.net.mean));
  }
  std::string list;
  for (const ForceCorrelation& entry : force.correlations) {
    if (std::abs(entry.correlation) < kClearCorrelation) continue;
    list +=
        fmt::format("{}the {} (correlation {:.2f}), as if {}", list.empty() ? "" : ", and with ",
                    entry.quantity, entry.correlation, SuggestionFor(entry));
  }
  if (list.empty()) return text;
  return text + fmt::format(" {} with {}.",
                            is_constant ? "Its varying part correlates" : "It correlates", list);
}

}  // namespace

std::string DescribeUnexplainedForce(const UnexplainedForceRecord& force,
                                     const std::string& recording) {
  const std::string title = recording + ", unexplained force: ";
  if (!force.usable) return title + "it could not be estimated, because " + force.message + ".";
  if (!force.fit.is_significant) {
    return title +
           fmt::format(
               "the smooth body force with which the model fits the recording best ({} rms) is not "
               "significant; its standard deviation is {}. It would change the error over all "
               "frames from {:.1f} σ to {:.1f} σ.",
               Newtons(force.net.rms.norm()), Newtons(force.net.rms_deviation.norm()),
               force.fit.rms_over_sigma_without, force.fit.rms_over_sigma_with);
  }
  std::string text = title + SizeText(force);
  if (!force.fit.converged)
    text += " The search for it has not converged, so that its size is approximate.";
  return text + PlaceText(force.place) + WorkText(force.work) + CauseText(force);
}

}  // namespace lacuna
