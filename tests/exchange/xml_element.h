// A small reader of XML for the tests: elements, attributes, text and comments, no entities.
#ifndef LACUNA_TESTS_EXCHANGE_XML_ELEMENT_H_
#define LACUNA_TESTS_EXCHANGE_XML_ELEMENT_H_

#include <map>
#include <string>
#include <vector>

namespace lacuna {

struct XmlElement {
  std::string name, text;
  std::map<std::string, std::string> attributes;
  std::vector<XmlElement> children;

  // The value of an attribute, or "" where it is absent.
  std::string Attribute(const std::string& key) const;
  std::vector<const XmlElement*> All(const std::string& child) const;
  // The first child of this name, or null.
  const XmlElement* Find(const std::string& child) const;
};

// The root element. Throws std::runtime_error where the text is not well formed: an element that is
// not closed, an attribute without quotation marks or written twice, two hyphens in a comment, text
// after the root element.
XmlElement ReadXml(const std::string& text);

}  // namespace lacuna

#endif  // LACUNA_TESTS_EXCHANGE_XML_ELEMENT_H_
