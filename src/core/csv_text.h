// Text in CSV files.
#ifndef LACUNA_CORE_CSV_TEXT_H_
#define LACUNA_CORE_CSV_TEXT_H_

#include <charconv>
#include <string>

namespace lacuna {

// `text` in double quotes, with each quote doubled (RFC 4180).
inline std::string QuotedCsv(const std::string& text) {
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + '"';
}

// `text` as one field, in quotes where it contains a quote, a line break or what may be taken for
// the delimiter. It is read back as it is.
inline std::string VerbatimCsvField(const std::string& text) {
  return text.find_first_of(",;\t\"\n\r") == std::string::npos ? text : QuotedCsv(text);
}

// Whether a spreadsheet would take `text` for a formula and evaluate it ("CSV injection", OWASP):
// it begins with one of = + - @, a tab or a line break, and is not a number.
inline bool IsSpreadsheetFormula(const std::string& text) {
  if (text.find_first_of("=+-@\t\r\n") != 0) return false;
  const char* begin = text.data() + (text.front() == '+' ? 1 : 0);
  const char* end = text.data() + text.size();
  double number = 0;
  const auto parsed = std::from_chars(begin, end, number);
  return parsed.ec == std::errc::invalid_argument || parsed.ptr != end;
}

// `text` as one field of a table for people, who may open it in a spreadsheet: a formula is made a
// text by an apostrophe in front of it, in quotes.
inline std::string CsvField(const std::string& text) {
  return IsSpreadsheetFormula(text) ? QuotedCsv("'" + text) : VerbatimCsvField(text);
}

}  // namespace lacuna

#endif  // LACUNA_CORE_CSV_TEXT_H_
