// The user's own mistakes, told so that they can be mended: file, line, column and field.
//
// Three kinds of failure are kept apart throughout Lacuna: the user's input (InputError, caught
// once in main), a numerical outcome (a status in the stage's result, never an exception) and our
// own mistakes (glog CHECK).
#ifndef LACUNA_CORE_ERROR_H_
#define LACUNA_CORE_ERROR_H_

#include <stdexcept>
#include <string>

namespace lacuna {

// A place in an input file. `line` and `column` count from 1; 0 means "the file as a whole".
struct SourcePosition {
  std::string file;
  int line = 0;
  int column = 0;
};

// Thrown for input that cannot be used. what() reads "file:line:column: message".
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
  InputError(const SourcePosition& position, const std::string& message)
      : std::runtime_error(Format(position, message)) {}

 private:
  static std::string Format(const SourcePosition& position, const std::string& message) {
    std::string text = position.file;
    if (position.line > 0) {
      text += ":" + std::to_string(position.line);
      if (position.column > 0) text += ":" + std::to_string(position.column);
    }
    return text.empty() ? message : text + ": " + message;
  }
};

// What `action` returns; an InputError out of it gets `where` in front of its message.
template <typename Action>
auto NamingWhere(const std::string& where, const Action& action) {
  try {
    return action();
  } catch (const InputError& problem) {
    throw InputError(where + ": " + problem.what());
  }
}

}  // namespace lacuna

#endif  // LACUNA_CORE_ERROR_H_
