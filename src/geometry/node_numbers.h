// The node numbers of a mesh file.
#ifndef LACUNA_GEOMETRY_NODE_NUMBERS_H_
#define LACUNA_GEOMETRY_NODE_NUMBERS_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>

#include "geometry/text_scanner.h"

namespace lacuna {

// Maps the node numbers of the file to indices in the list of nodes.
class NodeNumbers {
 public:
  // Throws InputError where the number is there already.
  void Add(long long number, const TextScanner& scanner) {
    const int place = static_cast<int>(place_.size());
    if (!place_.emplace(number, place).second)
      scanner.Fail("node " + std::to_string(number) + " appears a second time");
  }
  // Throws InputError where there is no such number.
  int Place(long long number, const TextScanner& scanner) const {
    const auto found = place_.find(number);
    if (found == place_.end()) scanner.Fail("there is no node " + std::to_string(number));
    return found->second;
  }

 private:
  // The finaliser of SplitMix64. The standard library takes whole numbers for their own hashes, so
  // that numbers with a common factor may all fall into one bucket.
  struct Hash {
    size_t operator()(long long number) const {
      auto bits = static_cast<uint64_t>(number);
      bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9;
      bits = (bits ^ bits >> 27) * 0x94d049bb133111eb;
      return bits ^ bits >> 31;
    }
  };
  std::unordered_map<long long, int, Hash> place_;
};

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_NODE_NUMBERS_H_
