// What of the CUDA engine can be chosen beside the device. Results do not depend on it.
#pragma once

namespace aligngs {

struct CudaEngineSettings {
  /// StepReport::seconds has a stage for a stage, as the CPU engine's, instead of "step" alone: time on the device.
  bool time_stages = false;
  /// A step becomes one CUDA graph (runtime/step_graph.h) instead of some 40 launches, except for the first visit to a
  /// view. Off until a device has shown what it gains: `aligngs bench --device cuda:N --graphs`.
  bool graphs = false;
};

}  // namespace aligngs
