#include "exchange/inp_labels.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lacuna {

void InpEntries::Add(size_t count, const InpLines& lines) {
  constexpr size_t kMost = 30'000'000;
  count_ += count;
  if (count_ > kMost)
    lines.Fail(fmt::format("the sets up to here have more than {} entries", kMost));
}

bool InpLabels::Add(int label, int index) { return index_.emplace(label, index).second; }

std::optional<int> InpLabels::IndexOf(int label) const {
  const auto found = index_.find(label);
  return found == index_.end() ? std::nullopt : std::optional(found->second);
}

InpLabels::Set* InpLabels::SetNamed(const std::string& name) {
  const auto [set, is_new] = sets_.try_emplace(name);
  if (is_new) order_.push_back(name);
  return &set->second;
}

const InpLabels::Set* InpLabels::FindSet(const std::string& name) const {
  const auto found = sets_.find(name);
  return found == sets_.end() ? nullptr : &found->second;
}

void InpLabels::AddLine(const InpLines& lines, Set* set) const {
  for (size_t k = 0; k < lines.Fields().size(); ++k) {
    if (lines.Fields()[k].empty()) continue;
    if (const Set* other = FindSet(InpName(lines.Fields()[k])); other != nullptr) {
      entries_->Add(other->size(), lines);
      if (other != set) set->insert(other->begin(), other->end());
      continue;
    }
    const int label = lines.Label(k, "a number or the name of a set above");
    entries_->Add(1, lines);
    if (index_.contains(label))
      set->insert(label);
    else if (!allows_unknown_)
      lines.Fail(fmt::format("there is no number {}", label));
  }
}

void InpLabels::AddRange(const InpLines& lines, Set* set) const {
  const long long first = lines.Label(0, "the first number");
  const long long last = lines.Label(1, "the last number");
  const long long step = lines.Fields().size() > 2 ? lines.Label(2, "the step") : 1;
  if (last < first) lines.Fail("the last number is smaller than the first");
  long long found = 0;
  for (auto at = index_.lower_bound(static_cast<int>(first));
       at != index_.end() && at->first <= last;) {
    entries_->Add(1, lines);
    if (const long long beyond = (at->first - first) % step; beyond != 0) {
      const long long next = at->first + step - beyond;
      at = next > last ? index_.end() : index_.lower_bound(static_cast<int>(next));
      continue;
    }
    ++found;
    set->insert(at->first);
    ++at;
  }
  if (const long long wanted = (last - first) / step + 1; found != wanted && !allows_unknown_)
    lines.Fail(fmt::format("{} of the {} numbers do not exist", wanted - found, wanted));
}

std::vector<NamedNodes> InpLabels::SetsInMesh(const std::vector<int>& kept,
                                              std::vector<std::string>* notes) const {
  std::vector<NamedNodes> named;
  for (const std::string& name : order_) {
    NamedNodes set{name, {}};
    size_t dropped = 0;
    for (const int label : sets_.at(name)) {
      const int index = kept[static_cast<size_t>(index_.at(label))];
      if (index >= 0) set.nodes.push_back(index);
      dropped += index < 0;
    }
    std::sort(set.nodes.begin(), set.nodes.end());
    if (dropped > 0)
      notes->push_back(fmt::format(
          "set {}: {} of its nodes belong to no tetrahedron and were dropped", name, dropped));
    if (set.nodes.empty())
      notes->push_back(fmt::format("set {}: it is empty and was left out", name));
    else
      named.push_back(std::move(set));
  }
  return named;
}

}  // namespace lacuna
