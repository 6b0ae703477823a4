// Reads protocols of the user's own (docs/plan.md):
//
//   schema_version: 1
//   stock: true                         whether the stock variants are tried too; the default
//   protocols:
//     - name: sideways
//       recording: recording 1          default: the first fitted one with markers
//       duration: 2                     factor
//       pull: 2                         factor
//       turn: {axis: [0, 1, 0], angle: 90 deg}
//       shake: {amplitude: [0, 5 mm, 0], frequency: 8 Hz}
//       weight: {mass: 5 g, place: [70 mm, 0, 0], radius: 4 mm}
//       more_markers: 8
#ifndef LACUNA_PLAN_PROTOCOL_READER_H_
#define LACUNA_PLAN_PROTOCOL_READER_H_

#include <vector>

#include "core/config.h"
#include "plan/protocol.h"

namespace lacuna {

struct ProtocolFile {
  bool stock = true;
  std::vector<Protocol> protocols;
  std::vector<Config> items;  // the entry of each protocol, for errors found later
};

// Throws InputError with file, line, column and field: for unknown keys, wrong units, a recording
// that the study does not have or that cannot be planned, a shaking that the frames or the study's
// time step cannot resolve (HighestShakeFrequency), and names that occur twice.
ProtocolFile ReadProtocols(const Config& config, const PredictionStudy& study);

}  // namespace lacuna

#endif  // LACUNA_PLAN_PROTOCOL_READER_H_
