// What of the CUDA engine can be chosen beside the device. Results do not depend on it.
#pragma once

namespace aligngs {

struct CudaEngineSettings {
  /// StepReport::seconds has a stage for a stage, as the CPU engine's, instead of "step" alone: time on the device.
  bool time_stages = false;
};

}  // namespace aligngs
