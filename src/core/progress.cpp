#include "core/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace aligngs {
namespace {

constexpr auto kTerminalInterval = std::chrono::milliseconds(100);  // 10 Hz: smooth, and cheap over ssh
constexpr auto kPlainInterval = std::chrono::seconds(10);           // a log stays readable

int terminal_columns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

ProgressStyle ProgressStyle::detect() {
  ProgressStyle style;
  const char* term = std::getenv("TERM");
  style.terminal = isatty(STDERR_FILENO) && !std::getenv("CI") && term && std::string_view(term) != "dumb";
  return style;
}

Progress::Progress(ProgressStyle style, std::string name, uint64_t total, uint64_t start)
    : style_(style),
      name_(std::move(name)),
      total_(total),
      start_(start),
      current_(start),
      begun_(Clock::now()),
      drawn_(begun_) {}

Progress::~Progress() {
  if (open_line_) std::fputc('\n', stderr);
}

bool Progress::due() const {
  if (!style_.enabled) return false;
  const auto since = Clock::now() - drawn_;
  return style_.terminal ? since >= kTerminalInterval : since >= kPlainInterval;
}

void Progress::update(uint64_t current, const std::string& detail) {
  current_ = current;
  if (!style_.enabled) return;
  const bool finished = current >= total_;
  if (!finished && !due()) return;
  detail_ = detail;
  draw(Clock::now());
}

void Progress::draw(Clock::time_point now) {
  drawn_ = now;
  const double elapsed = std::chrono::duration<double>(now - begun_).count();
  const double done = static_cast<double>(current_ - start_);
  const double rate = elapsed > 0 ? done / elapsed : 0;
  const double left = rate > 0 ? static_cast<double>(total_ - std::min(current_, total_)) / rate : 0;
  const double share = total_ > 0 ? std::min(1.0, static_cast<double>(current_) / static_cast<double>(total_)) : 1.0;
  const std::string tail =
      fmt::format("{}/{} {:3.0f}%  {}  {:.1f}/s  {} left {}", current_, total_, 100 * share, detail_, rate,
                  format_duration(elapsed), rate > 0 ? format_duration(left) : std::string("?"));
  if (!style_.terminal) {
    std::fputs(fmt::format("{} {}\n", name_, tail).c_str(), stderr);
    return;
  }
  const int bar = std::clamp(terminal_columns() - static_cast<int>(name_.size() + tail.size()) - 5, 0, 40);
  const int full = static_cast<int>(std::lround(share * bar));
  std::string line = "\r\033[2K" + name_ + " ";
  if (bar > 4) line += "[" + std::string(full, '#') + std::string(bar - full, '.') + "] ";
  std::fputs((line + tail).c_str(), stderr);
  std::fflush(stderr);
  open_line_ = true;
}

std::string format_duration(double seconds) {
  const long s = std::lround(std::max(0.0, seconds));
  if (s >= 3600) return fmt::format("{}:{:02d}:{:02d}", s / 3600, s / 60 % 60, s % 60);
  return fmt::format("{}:{:02d}", s / 60, s % 60);
}

std::string format_bytes(uint64_t bytes) {
  const char* units[] = {"B", "kB", "MB", "GB", "TB"};
  double value = static_cast<double>(bytes);
  int unit = 0;
  while (value >= 1000 && unit < 4) value /= 1000, ++unit;
  return unit == 0 ? fmt::format("{} B", bytes) : fmt::format("{:.1f} {}", value, units[unit]);
}

}  // namespace aligngs
