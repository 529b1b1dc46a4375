#include "train/memory_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/log.h"
#include "core/progress.h"
#include "train/closed_room.h"

namespace aligngs {
namespace {

// Without a growth factor (the paper): the hard cap of the published method, and at most half as many Gaussians as
// training pixels. 36 views of 640 x 480 give about the former.
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

GaussianCap fit_gaussian_cap(const CapInputs& in, const std::vector<MemoryToFit>& memories) {
  GaussianCap result;
  result.gaussians = cap_of_settings(in);
  const auto too_small = [&](uint64_t n) {  // the first memory that does not hold so many
    return std::find_if(memories.begin(), memories.end(),
                        [&](const MemoryToFit& m) { return m.budget.total() + m.bytes(n) > m.budget.limit(); });
  };
  const auto fits = [&](uint64_t n) { return too_small(n) == memories.end(); };
  if (!fits(result.gaussians) && fits(in.start_size)) {
    uint64_t low = in.start_size, high = result.gaussians;  // low fits, high does not
    while (high - low > 1) {
      const uint64_t middle = low + (high - low) / 2;
      (fits(middle) ? low : high) = middle;
    }
    const std::string& device = too_small(high)->device;
    result.warning = fmt::format("{} holds {} Gaussians, not the {} that the settings allow: growth stops there",
                                 device.empty() ? "memory" : "the memory of " + device, low, result.gaussians);
    result.gaussians = low;
  }
  for (const MemoryToFit& m : memories) {
    m.budget.add(fmt::format("{} Gaussians, {}", result.gaussians, m.what), m.bytes(result.gaussians));
    if (m.device.empty()) {
      m.budget.require("training", kMemoryRemedy);
    } else {
      m.budget.require("training on " + m.device, kDeviceMemoryRemedy);
    }
  }
  return result;
}

GaussianCap fit_to_engine(const CapInputs& in, const EngineFit& fit, MemoryBudget& host) {
  const Engine& engine = fit.engine;
  const auto in_the_end = [closes = in.config.train.closed_room && fit.channels > 0](uint64_t n) {
    return closes ? most_in_closed_room(n) : n;
  };
  const auto engine_bytes = [&](int channels) {
    return [&engine, in_the_end, channels, pixels = fit.pixels_per_view](uint64_t n) {
      return engine.predicted_bytes(in_the_end(n), channels, pixels);
    };
  };
  const auto say = [](const MemoryBudget& budget, const std::string& where) {
    log_info("memory{}: {} predicted, {} allowed", where, format_bytes(budget.total()), format_bytes(budget.limit()));
  };
  const std::optional<OwnMemory> own = engine.own_memory(fit.views, static_cast<int>(in.config.semantic.active_top));
  if (!own) {
    GaussianCap cap = fit_gaussian_cap(in, {{host, "optimiser, workspace", engine_bytes(fit.channels)}});
    say(host, "");
    return cap;
  }
  MemoryBudget device(std::max<uint64_t>(own->limit, 1));  // 0 would mean a share of the host's memory
  device.add("training views", own->views);
  const int channels = own->channels > 0 ? std::min(own->channels, fit.channels) : fit.channels;
  GaussianCap cap =
      fit_gaussian_cap(in, {{host, "copies for checkpoints",
                             [&](uint64_t n) { return engine.predicted_host_bytes(in_the_end(n), fit.channels); }},
                            {device, "optimiser, workspace", engine_bytes(channels), engine.device_name()}});
  say(host, "");
  say(device, " of " + engine.device_name());
  return cap;
}

}  // namespace aligngs
