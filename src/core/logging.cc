#include "core/logging.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "core/progress.h"

namespace lacuna {
namespace {

class StandardErrorSink : public google::LogSink {
 public:
  using google::LogSink::send;
  void send(google::LogSeverity severity, const char* /*full_filename*/, const char* base_filename,
            int line, const google::LogMessageTime& time, const char* message,
            size_t message_length) override {
    WriteLineToStandardError(fmt::format("{} {:02}:{:02}:{:02}.{:03} {}:{}] {}",
                                         google::GetLogSeverityName(severity)[0], time.hour(),
                                         time.min(), time.sec(), time.usec() / 1000, base_filename,
                                         line, std::string_view(message, message_length)));
  }
};

}  // namespace

void InitialiseLogging(const char* program, LogLevel level) {
  google::InitGoogleLogging(program);
  // Disable glog's own destinations, so that only this sink writes.
  for (int severity = 0; severity < google::NUM_SEVERITIES; ++severity) {
    google::SetLogDestination(severity, "");
  }
  FLAGS_stderrthreshold = google::NUM_SEVERITIES;
  static StandardErrorSink sink;
  google::AddLogSink(&sink);
  SetLogLevel(level);
}

void SetLogLevel(LogLevel level) {
  FLAGS_minloglevel = std::max(0, static_cast<int>(level) - 1);
  FLAGS_v = level == LogLevel::kDebug ? 1 : 0;
}

}  // namespace lacuna
