// The numbers of the nodes or of the elements of an .inp file, and the named sets of them.
#ifndef LACUNA_EXCHANGE_INP_LABELS_H_
#define LACUNA_EXCHANGE_INP_LABELS_H_

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "exchange/inp_lines.h"
#include "exchange/portable_model.h"

namespace lacuna {

// Counts the entries of all sets of a file, repetitions included. A short file could otherwise name
// a large set so often that its copies fill the memory.
class InpEntries {
 public:
  // Throws InputError at the present line once there are more than 30 million entries, which no
  // model that can be computed comes near.
  void Add(size_t count, const InpLines& lines);

 private:
  size_t count_ = 0;
};

class InpLabels {
 public:
  using Set = std::set<int>;  // numbers of nodes, or of elements

  // `entries` counts those of all sets of the file, and must outlive the object.
  explicit InpLabels(InpEntries* entries) : entries_(entries) {}

  // Adds the number of what has this index in the file. Returns false if the number is there
  // already.
  bool Add(int label, int index);
  // The index of what has this number; nothing if there is none.
  std::optional<int> IndexOf(int label) const;

  // From here on, unknown numbers in sets are taken for those of elements that are not read.
  void AllowUnknown() { allows_unknown_ = true; }
  bool AllowsUnknown() const { return allows_unknown_; }

  // The set of this name, which is added if there is none.
  Set* SetNamed(const std::string& name);
  // The set of this name; null if there is none.
  const Set* FindSet(const std::string& name) const;

  // Both add the present data line to a set: its numbers and the members of the sets that it names,
  // or the numbers from its first to its last with its step. Throw InputError at the line for a
  // number that is not there.
  void AddLine(const InpLines& lines, Set* set) const;
  void AddRange(const InpLines& lines, Set* set) const;

  // The sets in the order of their first mention, with indices in a mesh in place of numbers.
  // `kept`: for each index in the file that in the mesh, or −1. Empty sets are left out; that and
  // dropped members are noted.
  std::vector<NamedNodes> SetsInMesh(const std::vector<int>& kept,
                                     std::vector<std::string>* notes) const;

 private:
  InpEntries* entries_;
  std::map<int, int> index_;  // by number
  std::map<std::string, Set> sets_;
  std::vector<std::string> order_;  // names of the sets
  bool allows_unknown_ = false;
};

}  // namespace lacuna

#endif  // LACUNA_EXCHANGE_INP_LABELS_H_
