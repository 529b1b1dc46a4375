// Sends an open page the events of a run and the versions of its files, as Server-Sent Events.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "serve/served_run.h"

namespace aligngs {

/// One page's place in the history of a run.
class EventStream {
 public:
  /// `from`: the byte of events.ndjson at which the page left off, as digits; empty: from the beginning. `server`:
  /// changes when the server is started anew, so that an open page can load itself again.
  EventStream(const ServedRun& run, std::string_view from, std::string server);

  /// Text to send now: `server` first, then `events` (a JSON array; id: byte offset), `state` (a version) and, after
  /// ten silent seconds, a comment. Empty when there is nothing to tell.
  std::string next(std::chrono::steady_clock::time_point now);
  /// The last text had events, and more may be there: a long history comes in parts.
  bool has_more() const { return has_more_; }

 private:
  const ServedRun& run_;
  uint64_t offset_ = 0;
  bool has_more_ = false;
  std::string greeting_, version_ = "none";
  std::chrono::steady_clock::time_point last_sent_{};
};

}  // namespace aligngs
