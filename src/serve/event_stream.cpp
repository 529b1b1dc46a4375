#include "serve/event_stream.h"

#include <nlohmann/json.hpp>

#include "io/json_text.h"
#include "serve/event_lines.h"

namespace aligngs {

using namespace std::chrono_literals;

namespace {

constexpr auto kPingTime = 10s;
constexpr size_t kMostDigits = 15;  // of an offset: beyond every file, below 64 bits

}  // namespace

EventStream::EventStream(const ServedRun& run, std::string_view from, std::string server) : run_(run) {
  for (size_t i = 0; i < from.size() && i < kMostDigits && from[i] >= '0' && from[i] <= '9'; ++i) {
    offset_ = offset_ * 10 + static_cast<uint64_t>(from[i] - '0');
  }
  greeting_ = "retry: 1000\nevent: server\ndata: " + json_line(nlohmann::json(server)) + "\n\n";
}

std::string EventStream::next(std::chrono::steady_clock::time_point now) {
  std::string message = std::move(greeting_);
  greeting_.clear();
  const std::string lines = run_.events(offset_);
  has_more_ = !lines.empty();
  if (has_more_) message += "id: " + std::to_string(offset_) + "\nevent: events\ndata: " + event_array(lines) + "\n\n";
  if (std::string version = run_.signature(); version != version_) {
    version_ = std::move(version);
    message += "event: state\ndata: " + json_line(nlohmann::json(version_)) + "\n\n";
  }
  if (message.empty() && now - last_sent_ > kPingTime) message = ": ping\n\n";
  if (!message.empty()) last_sent_ = now;
  return message;
}

}  // namespace aligngs
