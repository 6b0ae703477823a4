// Numbers and words of a text file, line by line, with the place for each complaint.
#ifndef LACUNA_GEOMETRY_TEXT_SCANNER_H_
#define LACUNA_GEOMETRY_TEXT_SCANNER_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <string_view>

namespace lacuna {

// ".ply" of "Bar.PLY".
std::string LowerExtension(const std::filesystem::path& file);

class TextScanner {
 public:
  // Reads the whole file; throws InputError when it cannot. What follows `comment` on a line is
  // passed over.
  explicit TextScanner(const std::filesystem::path& file, char comment = '\0');

  // Goes to the next line that holds anything; false at the end of the file.
  bool NextLine();
  // The same where there must be one: `what` names what is missing at the end of the file.
  void ExpectLine(const std::string& what);

  // Reads from the line; throws InputError with the line when there is nothing (or not the right
  // thing) to read. Numbers are finite.
  std::string_view Word(const char* what);
  double Number(const char* what);
  long long Integer(const char* what);
  Eigen::Vector3d Point(const char* what);
  bool AtLineEnd();

  // As Word, but goes on to following lines.
  std::string_view WordAnywhere(const char* what);

  int Line() const { return line_number_; }
  [[noreturn]] void Fail(const std::string& message) const;

 private:
  std::filesystem::path file_;
  std::string content_;
  char comment_;
  size_t next_line_ = 0;
  std::string_view rest_;  // of the line
  int line_number_ = 0;
};

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_TEXT_SCANNER_H_
