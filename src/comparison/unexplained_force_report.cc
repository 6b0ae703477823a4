#include "comparison/unexplained_force_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lacuna {
namespace {

using nlohmann::json;

constexpr double kNear = 0.35, kFar = 0.65;  // of the largest distance from the grip
constexpr double kMostlyConstant = 0.7;      // of the rms
constexpr double kGoesWith = 0.7;            // correlation
constexpr double kClear = 2;                 // standard deviations

json Number(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }
json Vector(const Eigen::Vector3d& vector) {
  return {Number(vector[0]), Number(vector[1]), Number(vector[2])};
}

std::string Newtons(double force) { return fmt::format("{:.2g} N", force); }

std::string PlaceInWords(const UnexplainedForce& force) {
  if (force.farthest == 0) return "";
  const double share = force.grip_distance / force.farthest;
  return fmt::format(" Its centre lies {:.0f} mm from the grip (the farthest point {:.0f} mm): {}.",
                     1e3 * force.grip_distance, 1e3 * force.farthest,
                     share < kNear  ? "near the grip"
                     : share > kFar ? "toward the far end"
                                    : "it acts all along or in the middle");
}

std::string WorkInWords(const UnexplainedForce& force) {
  const double duration = force.times[force.times.size() - 1] - force.times[0];
  std::string text = fmt::format(" Its work over {:.2g} s is {:.2g} ± {:.1g} mJ", duration,
                                 1e3 * force.work, 1e3 * force.work_deviation);
  if (std::abs(force.work) < kClear * force.work_deviation)
    return text + ": it neither feeds nor drains the motion for certain.";
  return text + fmt::format(", {:.2g} mW on average: it {} the motion.", 1e3 * force.mean_power,
                            force.work > 0 ? "feeds" : "drains");
}

std::string LikenessInWords(const UnexplainedForce& force) {
  std::string text;
  if (force.constant_share > kMostlyConstant) {
    text += fmt::format(" It is mostly constant, {} toward {}, as a weight or a steady load is.",
                        Newtons(force.mean_force.norm()), DirectionInWords(force.mean_force));
  }
  std::string with;
  for (const ForceLikeness& likeness : force.likeness) {
    if (std::abs(likeness.correlation) < kGoesWith) continue;
    const bool along = likeness.correlation > 0;
    std::string hint;
    if (likeness.what == "displacement") {
      hint = along ? "the model is too stiff" : "the model is too soft";
    } else if (likeness.what == "velocity") {
      hint = along ? "the model is damped too much" : "a damping is missing";
    } else {
      hint = along ? "the model has too much mass" : "a mass is missing";
    }
    with += fmt::format("{}{} (correlation {:.2f}; {})", with.empty() ? "" : ", and with ",
                        likeness.what, likeness.correlation, hint);
  }
  if (with.empty()) return text;
  return text +
         (force.constant_share > kMostlyConstant ? " What varies of it goes with "
                                                 : " It goes with ") +
         with + ".";
}

}  // namespace

// More than 30 degrees off an axis: the second is named too.
std::string DirectionInWords(const Eigen::Vector3d& vector) {
  const Eigen::Vector3d unit = vector.normalized();
  int axes[] = {0, 1, 2};
  std::sort(std::begin(axes), std::end(axes),
            [&](int a, int b) { return std::abs(unit[a]) > std::abs(unit[b]); });
  const auto name = [&](int axis) {
    return fmt::format("{}{}", unit[axis] < 0 ? "−" : "+", "xyz"[axis]);
  };
  std::string text = name(axes[0]);
  if (std::abs(unit[axes[0]]) < 0.866) text += " and " + name(axes[1]);
  return text;
}

std::string ForceTableHeader() {
  return "recording,time_s,force_x_N,force_y_N,force_z_N,force_deviation_x_N,force_deviation_y_N,"
         "force_deviation_z_N,torque_x_Nm,torque_y_Nm,torque_z_Nm,torque_deviation_x_Nm,"
         "torque_deviation_y_Nm,torque_deviation_z_Nm,power_W,place_x_m,place_y_m,place_z_m\n";
}

std::string ForceTableRows(const UnexplainedForce& force, size_t recording) {
  std::string text;
  for (Eigen::Index k = 0; k < force.times.size(); ++k) {
    text += fmt::format("{},{}", recording, force.times[k]);
    for (const Eigen::Matrix3Xd* rows :
         {&force.force, &force.force_deviation, &force.torque, &force.torque_deviation})
      for (int axis = 0; axis < 3; ++axis) text += fmt::format(",{}", (*rows)(axis, k));
    text += fmt::format(",{}", force.power[k]);
    for (int axis = 0; axis < 3; ++axis) text += fmt::format(",{}", force.place(axis, k));
    text += "\n";
  }
  return text;
}

json ToJson(const UnexplainedForce& force) {
  if (!force.usable) return {{"usable", false}, {"message", force.message}};
  json likeness = json::object();
  for (const ForceLikeness& entry : force.likeness)
    likeness[entry.what] = Number(entry.correlation);
  return {{"usable", true},
          {"stands_out", force.stands_out},
          {"converged", force.converged},
          {"predictions", force.predictions},
          {"knots", force.field.KnotCount()},
          {"knot_spacing_s", force.field.spacing},
          {"weight_N", force.weight},
          {"rms_N", Vector(force.rms)},
          {"rms_deviation_N", Vector(force.rms_deviation)},
          {"mean_N", Vector(force.mean_force)},
          {"mean_deviation_N", Vector(force.mean_deviation)},
          {"constant_share", Number(force.constant_share)},
          {"correlation", likeness},
          {"work_J", Number(force.work)},
          {"work_deviation_J", Number(force.work_deviation)},
          {"mean_power_W", Number(force.mean_power)},
          {"place_m", Vector(force.mean_place)},
          {"place_grip_distance_m", Number(force.grip_distance)},
          {"farthest_grip_distance_m", Number(force.farthest)},
          {"in_noise_without", Number(force.in_noise_before)},
          {"in_noise_with", Number(force.in_noise_after)},
          {"log_evidence", Number(force.evidence)}};
}

std::string ForceInWords(const UnexplainedForce& force, const std::string& recording) {
  std::string text = recording + ", unexplained force: ";
  if (!force.usable) return text + "not known, " + force.message + ".";
  const std::string noise = fmt::format("the error would fall from {:.1f} to {:.1f} σ",
                                        force.in_noise_before, force.in_noise_after);
  if (!force.stands_out) {
    return text + fmt::format("no larger than its own uncertainty, {} rms of {} (with it {}).",
                              Newtons(force.rms.norm()), Newtons(force.rms_deviation.norm()),
                              noise);
  }
  text += fmt::format("a smooth body force of {} rms ({:.2g} % of the weight of what moves), ",
                      Newtons(force.rms.norm()), 100 * force.rms.norm() / force.weight);
  for (int axis = 0; axis < 3; ++axis)
    text += fmt::format("{}{:.2g} ± {:.1g} N in {}", axis > 0 ? ", " : "", force.rms[axis],
                        force.rms_deviation[axis], "xyz"[axis]);
  text += fmt::format(", would have made the model follow: {}.", noise);
  if (!force.converged) text += " Sought in steps, it has not settled: take its size as rough.";
  return text + PlaceInWords(force) + WorkInWords(force) + LikenessInWords(force);
}

}  // namespace lacuna
