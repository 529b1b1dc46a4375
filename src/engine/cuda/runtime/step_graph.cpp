// When a step is captured, and when it is launched one by one after all. The graphs themselves: step_graph.cu.
#include "engine/cuda/runtime/step_graph.h"

#include "core/log.h"

namespace aligngs::cuda {

void StepGraph::run(const std::function<void()>& body) {
  if (on_ && run_captured(body)) {
    failures_ = 0;
    ++counts_.launched;
    return;
  }
  if (on_) {
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
