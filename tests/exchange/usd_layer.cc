#include "exchange/usd_layer.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <stdexcept>
#include <string_view>

namespace lacuna {
namespace {

class UsdReader {
 public:
  explicit UsdReader(std::string_view text) : rest_(text) {}

  UsdLayer Layer() {
    constexpr std::string_view kHeader = "#usda 1.0\n";
    if (!rest_.starts_with(kHeader)) Fail("the header is not #usda 1.0");
    rest_.remove_prefix(kHeader.size());
    UsdLayer layer;
    if (Skips("(")) layer.metadata = Metadata();
    while (!AtEnd()) {
      Expect("def");
      AddChild(Prim(""), &layer.prims);
    }
    return layer;
  }

 private:
  [[noreturn]] void Fail(const std::string& what) const {
    throw std::runtime_error("USD: " + what + " before \"" + std::string(rest_.substr(0, 40)) +
                             "\"");
  }

  // Skips space and comments.
  bool AtEnd() {
    while (!rest_.empty()) {
      if (rest_.front() == '#')
        rest_.remove_prefix(std::min(rest_.find('\n'), rest_.size()));
      else if (std::isspace(static_cast<unsigned char>(rest_.front())) != 0)
        rest_.remove_prefix(1);
      else
        return false;
    }
    return true;
  }

  bool Skips(std::string_view mark) {
    if (AtEnd() || !rest_.starts_with(mark)) return false;
    rest_.remove_prefix(mark.size());
    return true;
  }

  void Expect(std::string_view mark) {
    if (!Skips(mark)) Fail("expected " + std::string(mark));
  }

  // Letters, digits and what else may stand in the name or the type of a property.
  std::string Word() {
    if (AtEnd()) Fail("a word is missing");
    size_t length = 0;
    while (length < rest_.size() &&
           (std::isalnum(static_cast<unsigned char>(rest_[length])) != 0 ||
            std::string_view("_:.").find(rest_[length]) != std::string_view::npos))
      ++length;
    if (rest_.substr(length).starts_with("[]")) length += 2;
    if (length == 0) Fail("a word is missing");
    std::string word(rest_.substr(0, length));
    rest_.remove_prefix(length);
    return word;
  }

  // The text up to `end`, which is skipped.
  std::string Until(char end) {
    const size_t at = rest_.find_first_of(std::string{end, '\n'});
    if (at == std::string_view::npos || rest_[at] != end) Fail("a text that is not closed");
    std::string text(rest_.substr(0, at));
    rest_.remove_prefix(at + 1);
    return text;
  }

  std::string Text() {
    Expect("\"");
    return Until('"');
  }

  double Number() {
    if (AtEnd()) Fail("a number is missing");
    double value = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (error != std::errc()) Fail("a number is missing");
    rest_.remove_prefix(static_cast<size_t>(end - rest_.data()));
    return value;
  }

  // The values up to `end`; a comma may follow the last one.
  UsdValue List(UsdValue::Kind kind, std::string_view end) {
    UsdValue list{kind, 0, {}, {}, {}};
    while (!Skips(end)) {
      if (kind == UsdValue::Kind::kSamples) {
        list.times.push_back(Number());
        Expect(":");
      }
      list.items.push_back(Value());
      if (Skips(",")) continue;
      Expect(end);
      break;
    }
    return list;
  }

  UsdValue Value() {
    if (Skips("(")) return List(UsdValue::Kind::kTuple, ")");
    if (Skips("[")) return List(UsdValue::Kind::kArray, "]");
    if (Skips("{")) return List(UsdValue::Kind::kSamples, "}");
    if (Skips("\"")) return {UsdValue::Kind::kText, 0, Until('"'), {}, {}};
    if (Skips("<")) return {UsdValue::Kind::kPath, 0, Until('>'), {}, {}};
    return {UsdValue::Kind::kNumber, Number(), {}, {}, {}};
  }

  // After "(".
  std::map<std::string, UsdValue> Metadata() {
    std::map<std::string, UsdValue> metadata;
    while (!Skips(")")) {
      Skips("prepend ");
      const std::string key = Word();
      Expect("=");
      if (!metadata.emplace(key, Value()).second) Fail(key + " stands twice");
    }
    return metadata;
  }

  UsdProperty Property() {
    UsdProperty property;
    property.is_custom = Skips("custom ");
    property.is_uniform = Skips("uniform ");
    property.type = Word();
    property.name = Word();
    constexpr std::string_view kSamples = ".timeSamples";
    const bool is_sampled = property.name.ends_with(kSamples);
    if (is_sampled) property.name.resize(property.name.size() - kSamples.size());
    Expect("=");
    property.value = Value();
    if (is_sampled != (property.value.kind == UsdValue::Kind::kSamples))
      Fail(property.name + " has time samples in a wrong way");
    if (Skips("(")) Metadata();
    return property;
  }

  void AddChild(UsdPrim prim, std::vector<UsdPrim>* siblings) {
    for (const UsdPrim& sibling : *siblings)
      if (sibling.name == prim.name) Fail("the prim " + prim.path + " stands twice");
    siblings->push_back(std::move(prim));
  }

  // After "def".
  UsdPrim Prim(const std::string& parent) {
    UsdPrim prim;
    prim.type = Word();
    prim.name = Text();
    prim.path = parent + "/" + prim.name;
    if (Skips("(")) prim.metadata = Metadata();
    Expect("{");
    while (!Skips("}")) {
      if (Skips("def ")) {
        AddChild(Prim(prim.path), &prim.children);
        continue;
      }
      UsdProperty property = Property();
      if (prim.Find(property.name) != nullptr) Fail(property.name + " stands twice");
      prim.properties.push_back(std::move(property));
    }
    return prim;
  }

  std::string_view rest_;
};

void AddAll(const std::vector<UsdPrim>& prims, std::vector<const UsdPrim*>* all) {
  for (const UsdPrim& prim : prims) {
    all->push_back(&prim);
    AddAll(prim.children, all);
  }
}

}  // namespace

std::vector<double> UsdValue::Numbers() const {
  if (kind == Kind::kNumber) return {number};
  std::vector<double> numbers;
  for (const UsdValue& item : items) {
    const std::vector<double> inner = item.Numbers();
    numbers.insert(numbers.end(), inner.begin(), inner.end());
  }
  return numbers;
}

std::vector<std::string> UsdValue::Texts() const {
  std::vector<std::string> texts;
  for (const UsdValue& item : items) texts.push_back(item.text);
  return texts;
}

const UsdProperty* UsdPrim::Find(const std::string& property) const {
  for (const UsdProperty& candidate : properties)
    if (candidate.name == property) return &candidate;
  return nullptr;
}

std::string UsdPrim::Text(const std::string& property) const {
  const UsdProperty* found = Find(property);
  return found == nullptr ? "" : found->value.text;
}

bool UsdPrim::Has(const std::string& api_schema) const {
  const auto found = metadata.find("apiSchemas");
  if (found == metadata.end()) return false;
  const std::vector<std::string> schemas = found->second.Texts();
  return std::find(schemas.begin(), schemas.end(), api_schema) != schemas.end();
}

std::vector<const UsdPrim*> UsdLayer::All() const {
  std::vector<const UsdPrim*> all;
  AddAll(prims, &all);
  return all;
}

const UsdPrim* UsdLayer::Find(const std::string& path) const {
  for (const UsdPrim* prim : All())
    if (prim->path == path) return prim;
  return nullptr;
}

UsdLayer ReadUsd(const std::string& text) { return UsdReader(text).Layer(); }

}  // namespace lacuna
