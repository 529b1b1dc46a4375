// The operations of a step as one CUDA graph instead of launches one by one. The operations of a step are captured anew
// each time. Nearly every kernel has an argument that changes with the step (camera, rates, room for pairs). The
// executable graph of the step before gets the new arguments, or is made anew if the operations differ. Emulated: a
// list of the operations, recorded and then carried out.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "device/device_memory.h"

namespace aligngs::cuda {

class StepGraph {
 public:
  struct Counts {
    uint64_t plain = 0;         ///< runs that were launched one by one
    uint64_t launched = 0;      ///< runs that were launched as a graph
    uint64_t instantiated = 0;  ///< executables that were made
    uint64_t updated = 0;       ///< executables that only got new arguments
    uint64_t failed = 0;        ///< captures that were given up
    uint64_t grown = 0;         ///< captures that were given up because memory had to grow, which is no failure
    size_t nodes = 0;           ///< operations of the last graph
  };
  /// Captures that fail in a row before there are no more.
  static constexpr uint64_t kMostFailures = 3;

  /// `on` == false: every run is launched one by one.
  StepGraph(const DeviceContext& context, bool on);
  ~StepGraph();
  StepGraph(const StepGraph&) = delete;
  StepGraph& operator=(const StepGraph&) = delete;

  /// Puts on the stream what `body` puts there. `body` may run twice: first captured, and if that fails, once more with
  /// plain launches. Capture fails if it waits for the device, takes memory, or the graph is refused. An exception of
  /// the second run is passed on. It must not read on the host what its own operations write.
  void run(const std::function<void()>& body);
  /// Forgets the executable graph: memory that it names is about to go.
  void drop();

  bool on() const { return on_; }
  const std::string& reason() const { return reason_; }  ///< why the last capture failed
  const Counts& counts() const { return counts_; }

 private:
  struct Executable;
  /// False: nothing is on the stream, reason_ says why.
  bool run_captured(const std::function<void()>& body);

  const DeviceContext* context_;
  bool on_;
  uint64_t failures_ = 0;  ///< in a row
  std::string reason_;
  Counts counts_;
  std::unique_ptr<Executable> executable_;
};

}  // namespace aligngs::cuda
