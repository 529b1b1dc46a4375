// When a step is captured, and when it is launched one by one after all. The graphs themselves: step_graph.cu.
#include "device/step_graph.h"

#include "core/log.h"

namespace aligngs::cuda {

namespace {

/// While it lives, memory cannot be taken.
class ScopedCapture {
 public:
  explicit ScopedCapture(const DeviceContext& context) : context_(context) { context.begin_capture(); }
  ~ScopedCapture() { context_.end_capture(); }
  ScopedCapture(const ScopedCapture&) = delete;
  ScopedCapture& operator=(const ScopedCapture&) = delete;
  bool growth_refused() const { return context_.growth_refused(); }

 private:
  const DeviceContext& context_;
};

}  // namespace

void StepGraph::run(const std::function<void()>& body) {
  bool grows = false;
  if (on_) {
    const ScopedCapture capture(*context_);
    if (run_captured(body)) {
      failures_ = 0;
      ++counts_.launched;
      return;
    }
    grows = capture.growth_refused();
  }
  if (grows) {
    ++counts_.grown;  // launched one by one it takes the memory, and the next step finds it
  } else if (on_) {
    ++counts_.failed;
    drop();
    if (++failures_ == kMostFailures) {
      on_ = false;
      log_warning("CUDA graphs are off for the rest of this run: {}", reason_);
    }
  }
  ++counts_.plain;
  body();
}

}  // namespace aligngs::cuda
