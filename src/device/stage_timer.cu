#include "device/stage_timer.h"

#include "device/cuda_check.h"
#ifdef ALIGNGS_CUDA_EMULATED
#include "device/emulation/tape.h"
#endif

namespace aligngs::cuda {

void StageTimer::start() {
  if (!on_) return;
  stages_.clear();
  times_.clear();
  marks_ = 0;
  running_ = true;
  record();
}

void StageTimer::mark(const char* stage) {
  if (!running_) return;
  stages_.push_back(stage);
  record();
}

#ifdef ALIGNGS_CUDA_EMULATED

StageTimer::~StageTimer() = default;

void StageTimer::record() {
  emulated_stream_operation("event", [this] { times_.push_back(std::chrono::steady_clock::now()); });
  ++marks_;
}

void StageTimer::read(std::map<std::string, double>& seconds) {
  for (size_t i = 0; running_ && i < stages_.size(); ++i) {
    seconds[stages_[i]] += std::chrono::duration<double>(times_[i + 1] - times_[i]).count();
  }
  running_ = false;
}

#else

StageTimer::~StageTimer() {
  for (CUevent_st* event : events_) (void)cudaEventDestroy(event);
}

void StageTimer::record() {
  context_->use();  // an event belongs to the device that is current
  if (marks_ == events_.size()) {
    CUevent_st* event = nullptr;
    check_cuda(cudaEventCreate(&event), "an event");
    events_.push_back(event);
  }
  cudaStreamCaptureStatus capturing = cudaStreamCaptureStatusNone;
  check_cuda(cudaStreamIsCapturing(context_->stream(), &capturing), "the state of the stream");
  // Part of a graph, an event is one that the host may ask only if it is recorded as external.
  const unsigned flags = capturing == cudaStreamCaptureStatusActive ? cudaEventRecordExternal : cudaEventRecordDefault;
  check_cuda(cudaEventRecordWithFlags(events_[marks_], context_->stream(), flags), "recording an event");
  ++marks_;
}

void StageTimer::read(std::map<std::string, double>& seconds) {
  for (size_t i = 0; running_ && i < stages_.size(); ++i) {
    float milliseconds = 0;
    check_cuda(cudaEventElapsedTime(&milliseconds, events_[i], events_[i + 1]), "time between two events");
    seconds[stages_[i]] += 1e-3 * static_cast<double>(milliseconds);
  }
  running_ = false;
}

#endif

}  // namespace aligngs::cuda
