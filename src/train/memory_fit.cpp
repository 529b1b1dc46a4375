#include "train/memory_fit.h"

#include <fmt/format.h>

#include <algorithm>

namespace aligngs {
namespace {

// Without a growth factor (the paper): the hard cap of the published method, and not more than half as many
// Gaussians as there are pixels to learn from; 36 views of 640 x 480 give just about the former.
constexpr double kMostGaussians = 6000000, kMostPerPixel = 0.5;

uint64_t cap_of_settings(const CapInputs& in) {
  const DensifyConfig& d = in.config.densify;
  if (!d.enabled) return in.start_size;
  uint64_t cap = static_cast<uint64_t>(d.max_gaussians);
  if (cap == 0) {
    // A sparse start says nothing about how many Gaussians the scene needs; the limit of dense starts does.
    const double base = static_cast<double>(in.dense_start ? in.start_size : static_cast<uint64_t>(in.start_limit));
    // A run cut short splits before colours have settled and has no time to use what it splits.
    const double length = std::min(1.0, static_cast<double>(in.config.train.iterations) /
                                            static_cast<double>(in.config.train.reference_iterations));
    const double most = std::min(kMostGaussians, kMostPerPixel * static_cast<double>(in.training_pixels)) * length;
    cap = static_cast<uint64_t>(d.max_growth > 0 ? std::min(d.max_growth * base, kMostGaussians) : most);
  }
  return std::max(cap, in.start_size);
}

}  // namespace

GaussianCap fit_gaussian_cap(const CapInputs& in, MemoryBudget& budget) {
  GaussianCap result;
  result.gaussians = cap_of_settings(in);
  const auto fits = [&](uint64_t n) { return budget.total() + in.bytes(n) <= budget.limit(); };
  if (!fits(result.gaussians) && fits(in.start_size)) {
    uint64_t low = in.start_size, high = result.gaussians;  // low fits, high does not
    while (high - low > 1) {
      const uint64_t middle = low + (high - low) / 2;
      (fits(middle) ? low : high) = middle;
    }
    result.warning = fmt::format("memory holds {} Gaussians, not the {} that the settings allow: growth stops there", low,
                                 result.gaussians);
    result.gaussians = low;
  }
  budget.add(fmt::format("{} Gaussians, optimiser, workspace", result.gaussians), in.bytes(result.gaussians));
  budget.require("training", kMemoryRemedy);
  return result;
}

}  // namespace aligngs
