// How many Gaussians a run may grow to: what its settings say, lowered to what memory holds.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/memory_budget.h"
#include "engine/engine.h"
#include "train/config.h"

namespace aligngs {

inline constexpr const char* kMemoryRemedy =
    "use --preset preview or a smaller --set data.scale, or lower --set init.max_gaussians";
inline constexpr const char* kDeviceMemoryRemedy =
    "use --preset preview or a smaller --set data.scale, lower --set init.max_gaussians, or train on the CPU (--device "
    "cpu)";

struct CapInputs {
  const TrainConfig& config;
  uint64_t start_size = 0;       ///< Gaussians at the start
  bool dense_start = false;      ///< they came from prior depth
  int64_t start_limit = 0;       ///< the most a start may have
  uint64_t training_pixels = 0;  ///< of all training views together, at the working resolution
};

/// A memory that the run must fit into.
struct MemoryToFit {
  MemoryBudget& budget;                               ///< holds already what does not depend on the number of Gaussians
  std::string what;                                   ///< takes the room: "optimiser, workspace"
  std::function<uint64_t(uint64_t gaussians)> bytes;  ///< for so many; grows with the number
  std::string device = {};                            ///< whose memory it is; empty: the host's
};

struct GaussianCap {
  uint64_t gaussians = 0;  ///< at least start_size
  std::string warning;     ///< set when memory, not the settings, decided, naming which
};

/// The smallest memory decides. Adds the Gaussians' share to every budget. Error{kResources} with the sum and a remedy
/// when even the start does not fit.
GaussianCap fit_gaussian_cap(const CapInputs& inputs, const std::vector<MemoryToFit>& memories);

struct EngineFit {
  const Engine& engine;
  const std::vector<TrainingView>& views;  ///< that it will be given
  int channels = 0;                        ///< classes of a Gaussian; 0: no semantics
  size_t pixels_per_view = 0;              ///< of the largest view
};

/// fit_gaussian_cap for the host's memory and, of an engine that has it, its own; says in the log what is predicted.
GaussianCap fit_to_engine(const CapInputs& inputs, const EngineFit& fit, MemoryBudget& host);

}  // namespace aligngs
