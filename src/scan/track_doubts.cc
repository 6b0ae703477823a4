#include "scan/track_doubts.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/first_few.h"
#include "core/median.h"

namespace lacuna {
namespace {

constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();
// Exchanged markers are near the places of each other: within this share of the distance from their
// own. Larger: fast markers that follow each other are taken for exchanged ones.
constexpr double kCrosswise = 0.25;
// An exchange moves both markers by so many times as much as most move.
constexpr double kBeyondMost = 3;
// A jump is so many times as long as the steps that it is compared with, and as the usual step, and
// more than this share of the size of the group of markers, so that rounding is none.
constexpr double kFarther = 5, kBeyondUsual = 20, kShareOfSize = 0.02;
// A marker moves if its range is so many times the usual step; noise alone reaches three.
constexpr double kMovingRange = 5;
constexpr Eigen::Index kFewestOthers = 3;
constexpr int kFewestRepeats = 3;     // frames
constexpr double kMostly = 0.8;       // a marker that never moves may repeat in all frames
constexpr double kImprobable = 1e-3;  // number of such repeats that rounding would cause

// m × n, m: how far each marker moved since the frame before; NaN where it was not seen in both.
Eigen::MatrixXd StepsOf(const std::vector<Eigen::Matrix3Xd>& positions) {
  const auto frames = static_cast<Eigen::Index>(positions.size());
  Eigen::MatrixXd steps = Eigen::MatrixXd::Constant(positions.front().cols(), frames, kNotKnown);
  for (Eigen::Index f = 1; f < frames; ++f)
    steps.col(f) = (positions[static_cast<size_t>(f)] - positions[static_cast<size_t>(f - 1)])
                       .colwise()
                       .norm()
                       .transpose();
  return steps;
}

// NaN if there are none.
double MedianOfKnown(const Eigen::Ref<const Eigen::MatrixXd>& values) {
  std::vector<double> known;
  for (const double value : values.reshaped())
    if (!std::isnan(value)) known.push_back(value);
  return Median(std::move(known));
}

// The diagonal of the bounding box of the markers that are seen, m, in most frames.
double SizeOf(const std::vector<Eigen::Matrix3Xd>& positions) {
  std::vector<double> sizes;
  for (const Eigen::Matrix3Xd& places : positions) {
    Eigen::AlignedBox3d box;
    for (const auto place : places.colwise())
      if (place.allFinite()) box.extend(Eigen::Vector3d(place));
    if (!box.isEmpty()) sizes.push_back(box.diagonal().norm());
  }
  return Median(std::move(sizes));
}

// The largest known entry except that of one marker, and how many there are.
struct LargestOther {
  double step = 0;
  Eigen::Index count = 0;
};
LargestOther FindLargestOther(const Eigen::Ref<const Eigen::VectorXd>& steps, Eigen::Index marker) {
  LargestOther largest;
  for (Eigen::Index m = 0; m < steps.size(); ++m) {
    if (m == marker || std::isnan(steps[m])) continue;
    largest.step = std::max(largest.step, steps[m]);
    ++largest.count;
  }
  return largest;
}

class TrackExamination {
 public:
  explicit TrackExamination(const MarkerTracks& tracks)
      : tracks_(tracks),
        steps_(StepsOf(tracks.positions)),
        usual_(MedianOfKnown(steps_)),
        size_(SizeOf(tracks.positions)) {
    const Eigen::MatrixXd known = (steps_.array() >= 0).cast<double>();
    const Eigen::MatrixXd zero = (steps_.array() == 0).cast<double>();
    known_of_frame_ = known.colwise().sum();
    known_of_marker_ = known.rowwise().sum();
    zeros_of_frame_ = zero.colwise().sum();
    zeros_of_marker_ = zero.rowwise().sum();
  }

  std::vector<std::string> Exchanges() const {
    std::vector<std::string> found;
    Eigen::Matrix3Xd last = Places(0);  // where each was seen last
    for (Eigen::Index f = 1; f < Frames(); ++f) {
      const Eigen::VectorXd moved = (Places(f) - last).colwise().norm().transpose();
      const double most = kBeyondMost * MedianOfKnown(moved);
      std::vector<Eigen::Index> far;
      for (Eigen::Index m = 0; m < moved.size(); ++m)
        if (moved[m] > most) far.push_back(m);
      for (size_t i = 0; i < far.size(); ++i)
        for (size_t j = i + 1; j < far.size(); ++j) {
          const Eigen::Index a = far[i], b = far[j];
          const double crosswise =
              (Places(f).col(a) - last.col(b)).norm() + (Places(f).col(b) - last.col(a)).norm();
          if (crosswise <= kCrosswise * (moved[a] + moved[b]))
            found.push_back(fmt::format("{} and {} in frame {}", Name(a), Name(b), f));
        }
      for (Eigen::Index m = 0; m < last.cols(); ++m)
        if (Places(f).col(m).allFinite()) last.col(m) = Places(f).col(m);
    }
    return found;
  }

  std::vector<std::string> Jumps() const {
    const std::vector<char> moves = MovingMarkers();
    const auto in_all = std::count(moves.begin(), moves.end(), true);
    std::vector<std::string> found;
    for (Eigen::Index m = 0; m < Markers(); ++m) {
      if (in_all - (moves[static_cast<size_t>(m)] ? 1 : 0) < kFewestOthers) continue;
      for (Eigen::Index f = 1; f < Frames(); ++f)
        if (Jumps(m, f))
          found.push_back(
              fmt::format("{} by {:.3g} mm in frame {}", Name(m), 1e3 * steps_(m, f), f));
    }
    return found;
  }

  std::vector<std::string> Repeats() const {
    std::vector<std::string> found;
    for (Eigen::Index m = 0; m < Markers(); ++m)
      for (Eigen::Index f = 1; f < Frames(); ++f) {
        Eigen::Index end = f;
        while (end < Frames() && steps_(m, end) == 0) ++end;
        if (IsNoChance(m, f, end))
          found.push_back(fmt::format("{} in frames {} to {}", Name(m), f - 1, end - 1));
        f = std::max(f, end - 1);
      }
    return found;
  }

 private:
  Eigen::Index Frames() const { return steps_.cols(); }
  Eigen::Index Markers() const { return steps_.rows(); }
  const Eigen::Matrix3Xd& Places(Eigen::Index frame) const {
    return tracks_.positions[static_cast<size_t>(frame)];
  }
  const std::string& Name(Eigen::Index marker) const {
    return tracks_.names[static_cast<size_t>(marker)];
  }

  // Which markers are seen at places farther apart than noise explains.
  std::vector<char> MovingMarkers() const {
    std::vector<char> moves;
    for (Eigen::Index m = 0; m < Markers(); ++m) {
      Eigen::AlignedBox3d box;
      for (const Eigen::Matrix3Xd& positions : tracks_.positions)
        if (positions.col(m).allFinite()) box.extend(Eigen::Vector3d(positions.col(m)));
      moves.push_back(!box.isEmpty() && box.diagonal().norm() > kMovingRange * usual_);
    }
    return moves;
  }

  bool Jumps(Eigen::Index m, Eigen::Index f) const {
    const double step = steps_(m, f);
    if (!(step > std::max(kBeyondUsual * usual_, kShareOfSize * size_))) return false;
    const LargestOther other = FindLargestOther(steps_.col(f), m);
    if (other.count < kFewestOthers || step <= kFarther * other.step) return false;
    const double small = step / kFarther;
    if (steps_(m, f - 1) > small) return false;  // it moved already
    if (f + 1 == Frames() || std::isnan(steps_(m, f + 1))) return false;
    const bool stays = steps_(m, f + 1) <= small;
    return stays || (Places(f + 1).col(m) - Places(f - 1).col(m)).norm() <= small;
  }

  // Whether the steps [begin, end) of a marker are 0 although its coordinates and those of the
  // others are not rounded so much that this happens by chance.
  bool IsNoChance(Eigen::Index m, Eigen::Index begin, Eigen::Index end) const {
    const auto repeats = static_cast<double>(end - begin);
    if (repeats + 1 < kFewestRepeats || repeats + 1 > kMostly * (known_of_marker_[m] + 1))
      return false;
    for (Eigen::Index f = begin; f < end; ++f)
      if (2 * (zeros_of_frame_[f] - 1) >= known_of_frame_[f] - 1) return false;
    const double own = known_of_marker_[m], zeros = zeros_of_marker_[m];
    const double others = known_of_marker_.sum() - own;
    if (others == 0) return false;
    const double chance = std::max((zeros_of_marker_.sum() - zeros) / others,
                                   (zeros - repeats) / std::max(1.0, own - repeats));
    return std::pow(chance, repeats) * static_cast<double>(steps_.size()) < kImprobable;
  }

  const MarkerTracks& tracks_;
  Eigen::MatrixXd steps_;
  double usual_ = kNotKnown;  // m, a step of a marker
  double size_ = kNotKnown;   // m, of the group of markers
  // The number of steps that are known, and of those that are 0.
  Eigen::VectorXd known_of_frame_, known_of_marker_, zeros_of_frame_, zeros_of_marker_;
};

}  // namespace

std::vector<std::string> DoubtsOfTracks(const MarkerTracks& tracks,
                                        const std::filesystem::path& file) {
  std::vector<std::string> doubts;
  if (tracks.positions.size() < 2 || tracks.names.empty()) return doubts;
  const TrackExamination examination(tracks);
  const auto add = [&](const char* what, const std::vector<std::string>& found, const char* why) {
    if (!found.empty())
      doubts.push_back(fmt::format("{}: {} {}: {}", file.string(), what, FirstFew(found), why));
  };
  add("markers are exchanged,", examination.Exchanges(),
      "each is where the other was seen last; exchange their columns there");
  add("markers jump,", examination.Jumps(),
      "no other marker moves a fifth as far; if it is another object or a number that means \"not "
      "seen\", leave the entries empty");
  add("markers repeat their coordinates exactly,", examination.Repeats(),
      "most others do not; where a marker was not seen, leave its entries empty");
  return doubts;
}

}  // namespace lacuna
