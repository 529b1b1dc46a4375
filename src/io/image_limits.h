// Largest size of a picture, and smallest size of its file, before memory is taken
// for it.
#pragma once

#include <cstdint>
#include <filesystem>

namespace aligngs {

constexpr int kMaxImageSide = 65535;               ///< pixels; JPEG's own limit
constexpr uint64_t kMaxImagePixels = 400'000'000;  ///< pixels; 1.6 GB as RGBA, twice the largest photo sensors

/// Error{kBadInput} when the size is zero or beyond the limits. Thrown, too, when `file_bytes`
/// bytes cannot hold the picture at `max_pixels_per_byte`, the best rate of its compression.
void require_plausible_image(uint64_t width, uint64_t height, uint64_t file_bytes, double max_pixels_per_byte,
                             const std::filesystem::path& name);

}  // namespace aligngs
