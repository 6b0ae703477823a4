// A soft bar that a jaw stretches slowly in front of a motion-capture system, with a load cell at
// the jaw: a tension test, from which a modulus follows with the force only.
#ifndef LACUNA_TESTS_SUPPORT_PULLED_BAR_H_
#define LACUNA_TESTS_SUPPORT_PULLED_BAR_H_

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "prediction/prediction_study.h"
#include "support/held_bar.h"

namespace lacuna {

struct PulledBarTruth {
  double young_modulus = 1e5;                              // Pa
  double noise = 5e-5;                                     // m, of a marker's coordinate
  double force_noise = 0.01;                               // N
  double tare = 0.08;                                      // N, of the load cell, along x
  double twist = 0;                                        // rad per frame, of the jaw about x
  double torque_noise = 1e-5;                              // N m
  double delay = 0;                                        // s, of the load cell
  double sign = 1;                                         // of its readings
  std::vector<std::shared_ptr<const Effect>> hidden = {};  // that a model may lack
};
inline constexpr int kPulledFrames = 16;      // at 1 Hz
inline constexpr double kStretch = 0.0005;    // m per frame
inline constexpr double kPulledUntil = 11.5;  // s: the frames after it are held out

// The mesh with which the data are made.
TetMesh PulledBarMesh();

// Writes recording.yaml, markers.csv, jaw.csv, force.csv, with the force and the torque about x,
// and box.off. `measured_force`: the entry of the jaw; empty: there is no load cell.
inline constexpr const char* kLoadCell =
    "{file: force.csv, time: t, x: fx, unit: N, deviation: 10 mN, tare_deviation: 0.3 N}";
void WritePulledBar(const std::filesystem::path& folder, const PulledBarTruth& truth,
                    const std::string& measured_force = kLoadCell,
                    const std::string& measured_torque = "");

// An experiment on it that fits Young's modulus from 0.15 MPa, with texts replaced.
std::string PulledBarExperiment(const std::filesystem::path& folder,
                                const std::map<std::string, std::string>& replaced = {});
PredictionStudy ReadPulledBarStudy(const std::filesystem::path& folder,
                                   const std::map<std::string, std::string>& replaced = {});

}  // namespace lacuna

#endif  // LACUNA_TESTS_SUPPORT_PULLED_BAR_H_
