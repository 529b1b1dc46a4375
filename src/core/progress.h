// Progress with the time left: a bar on a terminal, a plain line now and then elsewhere.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace aligngs {

/// Whether progress is drawn at all and how; decided once by the command line.
struct ProgressStyle {
  bool enabled = true;
  bool terminal = false;  ///< redraw one line in place (10 Hz) instead of plain lines (every 10 s)
  /// Terminal when standard error is one, TERM is not "dumb" and CI is not set.
  static ProgressStyle detect();
};

class Progress {
 public:
  Progress(ProgressStyle style, std::string name, uint64_t total, uint64_t start = 0);
  ~Progress();  ///< ends the line, also when the work ended early

  /// Reports `current` units done; `detail` is shown beside it (loss, PSNR). Cheap when nothing is due.
  void update(uint64_t current, const std::string& detail = {});
  bool due() const;  ///< whether the next update will draw: lets a caller skip formatting the detail

 private:
  using Clock = std::chrono::steady_clock;
  void draw(Clock::time_point now);

  ProgressStyle style_;
  std::string name_, detail_;
  uint64_t total_, start_, current_;
  Clock::time_point begun_, drawn_;
  bool open_line_ = false;
};

/// "1:05" or "1:02:03".
std::string format_duration(double seconds);
/// "12.3 MB" (powers of 1000).
std::string format_bytes(uint64_t bytes);

}  // namespace aligngs
