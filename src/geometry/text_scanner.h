// Reading of words and numbers from a text file, line by line, with errors that name the line.
#ifndef LACUNA_GEOMETRY_TEXT_SCANNER_H_
#define LACUNA_GEOMETRY_TEXT_SCANNER_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <string_view>

namespace lacuna {

// The extension of `file` in lower case: ".ply" for "Bar.PLY".
std::string LowerExtension(const std::filesystem::path& file);

class TextScanner {
 public:
  // Reads the whole file; throws InputError if that fails. On each line the character `comment` and
  // everything after it is ignored.
  explicit TextScanner(const std::filesystem::path& file, char comment = '\0');

  // Moves to the next line that is not blank; returns false at the end of the file.
  bool NextLine();
  // NextLine() where there must be one: throws InputError at the end of the file, naming the
  // missing `what`.
  void ExpectLine(const std::string& what);

  // Read the next item of the current line. Each throws InputError, naming the line and `what` was
  // expected, if the line ends or the item has the wrong form. Numbers must be finite.
  std::string_view Word(const char* what);
  double Number(const char* what);
  long long Integer(const char* what);
  long long Count(const char* what);  // a whole number that is not negative
  Eigen::Vector3d Point(const char* what);
  bool AtLineEnd();
  int WordsLeft() const;  // on the current line

  // Like Word, but moves to the next line if the current one has ended.
  std::string_view WordAnywhere(const char* what);

  int Line() const { return line_number_; }
  [[noreturn]] void Fail(const std::string& message) const;

 private:
  std::filesystem::path file_;
  std::string content_;
  char comment_;
  size_t next_line_ = 0;
  std::string_view rest_;  // the unread part of the line
  int line_number_ = 0;
};

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_TEXT_SCANNER_H_
