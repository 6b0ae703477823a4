// Set-up of glog: all log messages go to standard error, and no log files are written.
//
// A line has the form "W 12:03:44.123 sor_filter.cc:42] message".
#ifndef LACUNA_CORE_LOGGING_H_
#define LACUNA_CORE_LOGGING_H_

#include <glog/logging.h>

namespace lacuna {

enum class LogLevel { kDebug, kInfo, kWarning, kError };  // kDebug also shows VLOG(1)

// Call this once at the start of main. Messages below `level` are not shown; a failed CHECK is
// always shown.
void InitialiseLogging(const char* program, LogLevel level = LogLevel::kWarning);

// Changes the level, e.g. after the command line has been read.
void SetLogLevel(LogLevel level);

}  // namespace lacuna

#endif  // LACUNA_CORE_LOGGING_H_
