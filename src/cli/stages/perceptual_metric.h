// LPIPS of rendered against true views, when its weights are on this machine.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/image.h"
#include "core/thread_pool.h"
#include "priors/model_store.h"

namespace aligngs {

class PerceptualMetric {
 public:
  /// Looks for the weights on disk, never on the network. Without them (or with damaged ones) nothing is measured and
  /// reason() says why.
  PerceptualMetric(const ModelStore& store, ThreadPool& pool);
  ~PerceptualMetric();

  struct Distances {
    double canonical = 0;  ///< inputs brought to [-1, 1], as the authors of the metric say
    double unit = 0;       ///< inputs left in [0, 1], as the tables of the field have it
  };
  /// Both RGB in [0, 1], of one size; where `mask` (may be empty) is 0 they count as equal. Nothing below 16 x 16
  /// pixels.
  std::optional<Distances> measure(const ImageF& rendered, const ImageF& truth, const ImageF& mask) const;

  /// Why nothing is measured; empty when it is.
  const std::string& reason() const { return reason_; }

 private:
  struct Network;
  std::unique_ptr<Network> network_;
  std::string reason_;
};

}  // namespace aligngs
