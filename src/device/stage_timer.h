// How long the device works on each stage of a step. Marks are events on the stream: nothing waits for them.
#pragma once

#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "device/device_memory.h"

struct CUevent_st;

namespace aligngs::cuda {

/// Emulated: clocks of the host, which does the work itself.
class StageTimer {
 public:
  /// `on` == false: marks cost nothing and there is nothing to read.
  StageTimer(const DeviceContext& context, bool on) : context_(&context), on_(on) {}
  ~StageTimer();
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

  bool on() const { return on_; }
  /// The first stage begins with what is put on the stream next.
  void start();
  /// Ends a stage, which began where the one before it ended. A name may come twice: its times are added up. Without
  /// start() a mark does nothing, so that code which steps share with renderings may have marks.
  void mark(const char* stage);
  /// Adds the seconds of every stage since start() to `seconds` and stops. The stream must have been waited for.
  void read(std::map<std::string, double>& seconds);

 private:
  void record();

  const DeviceContext* context_;
  bool on_, running_ = false;
  std::vector<const char*> stages_;                           ///< stage i lies between marks i and i + 1
  std::vector<CUevent_st*> events_;                           ///< kept from step to step
  std::vector<std::chrono::steady_clock::time_point> times_;  ///< emulated
  size_t marks_ = 0;
};

}  // namespace aligngs::cuda
