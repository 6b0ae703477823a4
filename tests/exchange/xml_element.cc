#include "exchange/xml_element.h"

#include <cctype>
#include <stdexcept>
#include <string_view>

namespace lacuna {
namespace {

class XmlReader {
 public:
  explicit XmlReader(std::string_view text) : rest_(text) {}

  XmlElement Root() {
    if (Skips("<?xml")) Until("?>");
    SkipComments();
    XmlElement root = Element();
    SkipComments();
    if (!rest_.empty()) Fail("text after the root element");
    return root;
  }

 private:
  [[noreturn]] void Fail(const std::string& what) const {
    throw std::runtime_error("XML: " + what + " before \"" + std::string(rest_.substr(0, 40)) +
                             "\"");
  }

  bool Skips(std::string_view word) {
    if (!rest_.starts_with(word)) return false;
    rest_.remove_prefix(word.size());
    return true;
  }

  // The text before `end`, which is skipped, too.
  std::string Until(std::string_view end) {
    const size_t at = rest_.find(end);
    if (at == std::string_view::npos) Fail("no " + std::string(end));
    std::string text(rest_.substr(0, at));
    rest_.remove_prefix(at + end.size());
    return text;
  }

  void SkipSpace() {
    while (!rest_.empty() && std::isspace(static_cast<unsigned char>(rest_.front())) != 0)
      rest_.remove_prefix(1);
  }

  void SkipComments() {
    SkipSpace();
    while (Skips("<!--")) {
      Until("--");
      if (!Skips(">")) Fail("two hyphens inside a comment");
      SkipSpace();
    }
  }

  std::string Name() {
    size_t length = 0;
    while (length < rest_.size() &&
           (std::isalnum(static_cast<unsigned char>(rest_[length])) != 0 || rest_[length] == '_'))
      ++length;
    if (length == 0) Fail("a name is missing");
    std::string name(rest_.substr(0, length));
    rest_.remove_prefix(length);
    return name;
  }

  XmlElement Element() {
    if (!Skips("<")) Fail("an element is missing");
    XmlElement element{Name(), {}, {}, {}};
    for (SkipSpace(); !rest_.starts_with('>') && !rest_.starts_with('/'); SkipSpace()) {
      const std::string key = Name();
      if (!Skips("=\"")) Fail("an attribute without quotation marks");
      if (!element.attributes.emplace(key, Until("\"")).second) Fail("an attribute twice");
    }
    if (Skips("/>")) return element;
    if (!Skips(">")) Fail("a tag that is not closed");
    for (SkipComments(); !rest_.starts_with("</"); SkipComments()) {
      if (rest_.empty()) Fail(element.name + " is not closed");
      if (rest_.starts_with('<')) {
        element.children.push_back(Element());
        continue;
      }
      const size_t end = rest_.find('<');
      if (end == std::string_view::npos) Fail(element.name + " is not closed");
      element.text += rest_.substr(0, end);
      rest_.remove_prefix(end);
    }
    if (!Skips("</" + element.name + ">")) Fail(element.name + " is not closed");
    return element;
  }

  std::string_view rest_;
};

}  // namespace

std::string XmlElement::Attribute(const std::string& key) const {
  const auto found = attributes.find(key);
  return found == attributes.end() ? "" : found->second;
}

std::vector<const XmlElement*> XmlElement::All(const std::string& child) const {
  std::vector<const XmlElement*> found;
  for (const XmlElement& element : children)
    if (element.name == child) found.push_back(&element);
  return found;
}

const XmlElement* XmlElement::Find(const std::string& child) const {
  const std::vector<const XmlElement*> found = All(child);
  return found.empty() ? nullptr : found.front();
}

XmlElement ReadXml(const std::string& text) { return XmlReader(text).Root(); }

}  // namespace lacuna
