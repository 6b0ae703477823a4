// Quoting of text in CSV files.
#ifndef LACUNA_RECORD_CSV_TEXT_H_
#define LACUNA_RECORD_CSV_TEXT_H_

#include <string>

namespace lacuna {

// `text` as one field (RFC 4180): in double quotes if it contains a comma, a quote or a line break,
// with each quote doubled.
inline std::string CsvField(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + '"';
}

}  // namespace lacuna

#endif  // LACUNA_RECORD_CSV_TEXT_H_
