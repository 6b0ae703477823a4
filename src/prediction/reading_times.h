// The times at which a predicted motion is read: those of frames, and those of load cells that are
// read later or earlier than the frames.
#ifndef LACUNA_PREDICTION_READING_TIMES_H_
#define LACUNA_PREDICTION_READING_TIMES_H_

#include <cstddef>
#include <vector>

namespace lacuna {

// A time at which a frame is seen, load cells are read, or both.
struct ReadingTime {
  double time = 0;           // s
  size_t frame = 0;          // its number, or that of the reading
  bool shows_frame = false;  // whether the points of the frame are seen
  std::vector<size_t> cells;
};

// All of them, ascending; at equal times in the order frames, first cell, second cell. For each
// cell, `cell_times` (s, of any number) are the times of its readings; empty: it is read with the
// frames.
std::vector<ReadingTime> ReadingTimesOf(const std::vector<double>& frame_times,
                                        const std::vector<std::vector<double>>& cell_times);

// The times (s) of what is read with this delay (s): each of `times` minus the delay.
std::vector<double> Delayed(std::vector<double> times, double delay);

// The times of all entries, in their order, s.
std::vector<double> TimesOf(const std::vector<ReadingTime>& readings);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_READING_TIMES_H_
