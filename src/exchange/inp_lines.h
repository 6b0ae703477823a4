// The lines of an input file of Abaqus or CalculiX: keyword lines with their parameters, and data
// lines of fields between commas.
//
// Keywords, parameters and names of sets do not distinguish capital letters; they are returned in
// capital letters. Comments (**) and blank lines are skipped; a keyword line that ends with a comma
// continues on the next line. All functions throw InputError with file and line.
#ifndef LACUNA_EXCHANGE_INP_LINES_H_
#define LACUNA_EXCHANGE_INP_LINES_H_

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace lacuna {

// A keyword, a parameter or the name of a set as it is compared: in capital letters, without blanks
// and a pair of double quotes around it.
std::string InpName(std::string_view text);

class InpLines {
 public:
  // Reads the whole file.
  explicit InpLines(const std::filesystem::path& file);

  // Moves to the next keyword or data line; returns false at the end of the file.
  bool Next();

  bool IsKeyword() const { return is_keyword_; }
  const std::string& Keyword() const { return keyword_; }  // "ELEMENT", of the last keyword line
  // The value of a parameter of the last keyword line, "" where it has none; null where it is
  // absent.
  const std::string* Parameter(const std::string& name) const;
  // Parameter() for one that must be there and have a value. Throws InputError otherwise.
  const std::string& RequiredParameter(const std::string& name) const;
  // Refuses a parameter of that keyword line that is not among `known`.
  void RefuseParametersBut(const std::set<std::string>& known) const;
  // The keyword line as it stands in the file, without what continues it, and its line number. It
  // has no control characters.
  const std::string& KeywordText() const { return keyword_text_; }
  int KeywordLine() const { return keyword_line_; }

  // The fields of the present data line, without blanks around them. An empty field after the last
  // comma is not counted.
  const std::vector<std::string_view>& Fields() const { return fields_; }
  bool EndsWithComma() const { return ends_with_comma_; }
  // Field k as a finite number or as a whole number from 1 to 2 147 483 647; `what` was expected.
  double Number(size_t k, const char* what) const;
  int Label(size_t k, const char* what) const;

  int Line() const { return line_; }
  [[noreturn]] void Fail(const std::string& message) const;

 private:
  bool NextText(std::string_view* text);
  void ReadKeyword(std::string_view text);

  std::filesystem::path file_;
  std::string content_;
  size_t next_ = 0;
  int line_ = 0, keyword_line_ = 0;
  bool is_keyword_ = false, ends_with_comma_ = false;
  std::string keyword_, keyword_text_;
  std::map<std::string, std::string> parameters_;
  std::vector<std::string_view> fields_;
};

}  // namespace lacuna

#endif  // LACUNA_EXCHANGE_INP_LINES_H_
