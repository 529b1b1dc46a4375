// How much memory a room will take, told from its photos before anything is read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "priors/network_memory.h"
#include "train/run_record.h"

namespace aligngs {

/// Bytes of the largest network with what it makes, for photos that a network not looked at may see.
inline constexpr uint64_t kLargestNetworkBytes = 7'000'000'000;  // ViT-g Mask2Former (benchmarks/README.md)

/// Bytes of a training on so many pixels of photos together.
uint64_t estimated_training_bytes(uint64_t pixels);

/// Sizes of the pictures in a folder, or in its images/, reduced to `longest` pixels as a run reduces them. Only the
/// headers are read; files that are no pictures are left out.
std::vector<NetworkInput> sizes_of_photos(const std::filesystem::path& source, int longest = 1600);

uint64_t pixels_of(const std::vector<NetworkInput>& photos);

/// Record of the training in a run folder, which may be one that is replaced; empty without one.
std::optional<RunRecord> earlier_run(const std::filesystem::path& run);

/// Peak that a run is expected to have after an earlier one of the same room: a tenth more; 0 where it is unknown.
uint64_t expected_peak_bytes(const std::optional<RunRecord>& earlier);

}  // namespace aligngs
