#include "device/step_graph.h"

#include <exception>

#ifdef ALIGNGS_CUDA_EMULATED
#include "device/emulation/tape.h"
#else
#include "device/cuda_check.h"
#endif

namespace aligngs::cuda {

#ifdef ALIGNGS_CUDA_EMULATED

struct StepGraph::Executable {
  EmulatedTape tape;
};

bool StepGraph::run_captured(const std::function<void()>& body) {
  auto captured = std::make_unique<Executable>();
  try {
    const ScopedRecording recording(captured->tape);
    body();
  } catch (const std::exception& error) {
    reason_ = error.what();
    return false;
  }
  if (executable_ != nullptr && executable_->tape.like(captured->tape)) {
    ++counts_.updated;
  } else {
    ++counts_.instantiated;
  }
  executable_ = std::move(captured);
  counts_.nodes = executable_->tape.size();
  executable_->tape.play();
  return true;
}

#else

struct StepGraph::Executable {
  cudaGraphExec_t graph = nullptr;
  ~Executable() {
    if (graph != nullptr) (void)cudaGraphExecDestroy(graph);
  }
};

namespace {

/// The operations of one capture.
struct CapturedGraph {
  cudaGraph_t graph = nullptr;
  CapturedGraph() = default;
  ~CapturedGraph() {
    if (graph != nullptr) (void)cudaGraphDestroy(graph);
  }
  CapturedGraph(const CapturedGraph&) = delete;
  CapturedGraph& operator=(const CapturedGraph&) = delete;
};

/// Ends the capture in any case: a stream that captures takes no other work. Empty: captured.
std::string capture(CUstream_st* stream, const std::function<void()>& body, CapturedGraph& out) {
  // Captures this thread alone: calls of other threads are no part of the step and do not spoil it.
  const cudaError_t begun = cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal);
  if (begun != cudaSuccess) {
    (void)cudaGetLastError();
    return std::string("the capture does not begin: ") + cudaGetErrorString(begun);
  }
  std::string problem;
  try {
    body();
  } catch (const std::exception& error) {
    problem = error.what();
  }
  const cudaError_t ended = cudaStreamEndCapture(stream, &out.graph);
  if (ended != cudaSuccess) {
    (void)cudaGetLastError();  // not sticky; the next launch must not report it
    if (problem.empty()) problem = cudaGetErrorString(ended);
  }
  if (problem.empty() && out.graph == nullptr) problem = "the capture left no graph";
  return problem;
}

}  // namespace

bool StepGraph::run_captured(const std::function<void()>& body) {
  context_->use();
  CapturedGraph captured;
  reason_ = capture(context_->stream(), body, captured);
  if (!reason_.empty()) return false;
  if (cudaGraphGetNodes(captured.graph, nullptr, &counts_.nodes) != cudaSuccess) (void)cudaGetLastError();
  if (executable_ != nullptr) {
    cudaGraphExecUpdateResultInfo result{};
    if (cudaGraphExecUpdate(executable_->graph, captured.graph, &result) == cudaSuccess) {
      ++counts_.updated;
    } else {
      (void)cudaGetLastError();
      drop();
    }
  }
  if (executable_ == nullptr) {
    auto fresh = std::make_unique<Executable>();
    const cudaError_t made = cudaGraphInstantiate(&fresh->graph, captured.graph, 0);
    if (made != cudaSuccess) {
      (void)cudaGetLastError();
      reason_ = std::string("the graph cannot be instantiated: ") + cudaGetErrorString(made);
      return false;
    }
    executable_ = std::move(fresh);
    ++counts_.instantiated;
  }
  check_cuda(cudaGraphLaunch(executable_->graph, context_->stream()), "launching the graph of a step");
  return true;
}

#endif

// Defined here, as Executable is complete here.
StepGraph::StepGraph(const DeviceContext& context, bool on) : context_(&context), on_(on) {}
StepGraph::~StepGraph() = default;
void StepGraph::drop() { executable_.reset(); }

}  // namespace aligngs::cuda
