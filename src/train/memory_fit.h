// How many Gaussians a run may grow to: what its settings say, lowered to what memory holds.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "core/memory_budget.h"
#include "train/config.h"

namespace aligngs {

inline constexpr const char* kMemoryRemedy =
    "use --preset preview or a smaller --set data.scale, or lower --set init.max_gaussians";

struct CapInputs {
  const TrainConfig& config;
  uint64_t start_size = 0;   ///< Gaussians at the start
  bool dense_start = false;  ///< they came from prior depth
  int64_t start_limit = 0;   ///< the most a start may have
  uint64_t training_pixels = 0;  ///< of all training views together, at the working resolution
  std::function<uint64_t(uint64_t gaussians)> bytes;  ///< what the engine needs for so many; grows with the number
};

struct GaussianCap {
  uint64_t gaussians = 0;  ///< at least start_size
  std::string warning;     ///< set when memory, not the settings, decided
};

/// Adds the engine's share to the budget. Error{kResources} with the sum when even the start does not fit.
GaussianCap fit_gaussian_cap(const CapInputs& inputs, MemoryBudget& budget);

}  // namespace aligngs
