// The exception for errors in the user's input, with the position in the file.
//
// Lacuna distinguishes three kinds of failure: errors in the user's input (InputError, caught once
// in main), numerical failures such as no convergence (a status in the result, never an exception)
// and programming errors (glog's CHECK). Two more exceptions end what is being computed without a
// result, and are caught in main, too: OutOfMemory (core/memory_limit.h) and Interrupted
// (core/interrupt.h).
#ifndef LACUNA_CORE_ERROR_H_
#define LACUNA_CORE_ERROR_H_

#include <stdexcept>
#include <string>

namespace lacuna {

// A position in an input file. `line` and `column` count from 1; line 0 means the file as a whole.
struct SourcePosition {
  std::string file;
  int line = 0;
  int column = 0;
};

// Thrown for input that cannot be used. what() has the form "file:line:column: message" without the
// parts that are unknown.
class InputError : public std::runtime_error {
 public:
  // For input that has no position, such as an argument of the command line.
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

// Calls `action` and returns its result. If it throws an InputError, that error is rethrown as an
// InputError with "where: " in front of its message.
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
