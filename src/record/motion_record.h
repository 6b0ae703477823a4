// The motion of a model for one recording, as a report draws it: the file
// <run>/shown_motion/<number of the recording>.json of a fit, results/shown_motion.json of a
// reconstruction.
//
// Positions and fields are quantised (packed_array.h), so that the file is small. Nothing is
// computed from it. Lengths are in m, in the recording's coordinates.
#ifndef LACUNA_RECORD_MOTION_RECORD_H_
#define LACUNA_RECORD_MOTION_RECORD_H_

#include <Eigen/Core>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace lacuna {

// The most frames and vertices that are kept. Larger: smoother drawings, larger reports.
inline constexpr int kMostShownFrames = 100;
inline constexpr int kMostShownVertices = 20000;
// The most measured points of one scan that are kept.
inline constexpr int kMostShownPoints = 4000;

// Values at the vertices of the surface.
struct ShownField {
  std::string name, label, unit;  // "speed", "speed", "m/s"
  Eigen::MatrixXd values;         // vertices × frames
};

struct MotionRecord {
  std::string fit;                    // hash of calibration.json; empty for a reconstruction
  std::string recording;              // its name
  Eigen::VectorXd times;              // s, ascending, one for each frame
  std::optional<Eigen::Vector3d> up;  // unit vector against gravity, where it is known
  Eigen::Matrix3Xi triangles;         // counter-clockwise seen from outside
  Eigen::MatrixXd positions;          // 3·vertices × frames, x, y, z of a vertex in three rows
  std::vector<ShownField> fields;
  std::vector<Eigen::Matrix3Xd> scans;  // measured points of each frame; empty: kept elsewhere
  // Sentences about what was left out.
  std::vector<std::string> notes;
};

// The file of recording number `recording` in the folder of a fit.
std::filesystem::path MotionFile(const std::filesystem::path& run, size_t recording);

// Writes the motion, atomically, with as many vertices and frames as it has: whoever makes the
// record chooses them (geometry/thinned_surface.h). Scans are thinned to kMostShownPoints. The
// folder must exist. Throws InputError where the file cannot be written; arrays of other lengths
// than the number of frames or vertices are programming errors (CHECK).
void WriteMotionFile(const MotionRecord& record, const std::filesystem::path& file);

// The parts of a motion that a report shows, as src/report/page/README.md describes them. Arrays
// stay packed.
struct StoredMotion {
  std::string fit, recording;
  nlohmann::json times, up, surface, points;  // null where there is none
  std::vector<std::string> notes;
};
// Throws InputError when the file is absent, damaged or of another schema version.
StoredMotion ReadMotionFile(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_RECORD_MOTION_RECORD_H_
