// Where log messages go: glog, one sink, standard error.
//
// A line reads "W 12:03:44.123 sor_filter.cc:42] message". No log files are written.
#ifndef LACUNA_CORE_LOGGING_H_
#define LACUNA_CORE_LOGGING_H_

#include <glog/logging.h>

namespace lacuna {

enum class LogLevel { kDebug, kInfo, kWarning, kError };  // kDebug also shows VLOG(1)

// Call once, first thing in main. Messages below `level` are dropped; a failed CHECK always shows.
void InitialiseLogging(const char* program, LogLevel level = LogLevel::kWarning);

// May be called again, e.g. when the command line has been read.
void SetLogLevel(LogLevel level);

}  // namespace lacuna

#endif  // LACUNA_CORE_LOGGING_H_
