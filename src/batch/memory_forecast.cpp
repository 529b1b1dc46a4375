#include "batch/memory_forecast.h"

#include <algorithm>
#include <charconv>
#include <cstdio>

#include "batch/option_words.h"
#include "core/error.h"
#include "io/image_file.h"
#include "train/run_folder.h"
#include "train/run_record.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

// A line a tenth above the largest peak that was measured per pixel (docs/batch.md): 20 photos of 640x480 with all
// classes.
constexpr uint64_t kFixedBytes = 400'000'000;
constexpr uint64_t kBytesPerPixel = 450;
constexpr uint64_t kNetworkBytes = 7'000'000'000;  // of the largest network, ViT-g Mask2Former (benchmarks/README.md)
constexpr double kEarlierPeakFactor = 1.1;         // a second run of a room peaks within a tenth of the first
constexpr uint64_t kLongestSide = 1600;            // pixels: larger photos are reduced by `run` before anything else

/// Defaults of `demo` without --size and --views (synth/synth_options.h).
constexpr uint64_t kSyntheticPixels = 320 * 240, kSyntheticViews = 24;

uint64_t number_or(const std::string& text, uint64_t otherwise) {
  uint64_t value = 0;
  const auto [rest, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  return failed == std::errc() && rest == text.data() + text.size() ? value : otherwise;
}

uint64_t synthetic_pixels(const RoomEntry& room) {
  unsigned width = 0, height = 0;
  const std::string size = option_value(room.options, "--size");
  const uint64_t pixels =
      std::sscanf(size.c_str(), "%5ux%5u", &width, &height) == 2 ? uint64_t(width) * height : kSyntheticPixels;
  return pixels * number_or(option_value(room.options, "--views"), kSyntheticViews);
}

uint64_t photo_pixels(const fs::path& source) {
  std::error_code error;
  const fs::path folder = fs::is_directory(source / "images", error) ? source / "images" : source;
  uint64_t pixels = 0;
  for (fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error), end;
       entry != end; entry.increment(error)) {
    if (!entry->is_regular_file(error)) continue;
    try {
      const ImageInfo info = read_image_info(entry->path());
      const uint64_t width = static_cast<uint64_t>(info.width), height = static_cast<uint64_t>(info.height);
      const uint64_t longest = std::max(width, height);
      pixels +=
          longest <= kLongestSide ? width * height : width * kLongestSide / longest * (height * kLongestSide / longest);
    } catch (const Error&) {
      // No picture, or one that the run will name.
    }
  }
  return pixels;
}

/// Whether networks may find cameras or classes of the room before it is trained.
bool may_use_networks(const Batch& batch, const RoomEntry& room) {
  std::error_code error;
  if (room.synthetic() || fs::exists(batch.source_of(room) / "sparse", error)) return false;
  const std::string method = option_value(room.options, "--method");
  return !((method == "colmap" || method == "given") && option_value(room.options, "--semantics") == "none");
}

uint64_t earlier_peak(const fs::path& run) {
  const RunFolder folder(run);
  return folder.has_run() ? read_run_record(folder.record()).train.peak_memory_bytes : 0;
}

}  // namespace

uint64_t estimated_bytes(uint64_t pixels) { return kFixedBytes + kBytesPerPixel * pixels; }

uint64_t predicted_room_bytes(const BatchFolder& folder, const Batch& batch, const RoomEntry& room) {
  if (const double gigabytes = std::strtod(option_value(room.options, "--memory").c_str(), nullptr); gigabytes > 0) {
    return static_cast<uint64_t>(gigabytes * 1e9);
  }
  if (const uint64_t peak = earlier_peak(folder.run(room.name)); peak > 0)
    return static_cast<uint64_t>(kEarlierPeakFactor * static_cast<double>(peak));
  const uint64_t training =
      estimated_bytes(room.synthetic() ? synthetic_pixels(room) : photo_pixels(batch.source_of(room)));
  return may_use_networks(batch, room) ? std::max(training, kNetworkBytes) : training;
}

uint64_t memory_share(uint64_t predicted, uint64_t budget, int jobs) {
  return std::min(budget, std::max(predicted, budget / static_cast<uint64_t>(std::max(1, jobs))));
}

}  // namespace aligngs
