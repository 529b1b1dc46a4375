#include "pipeline/room_memory.h"

#include <algorithm>
#include <system_error>

#include "core/error.h"
#include "io/image_file.h"
#include "train/run_folder.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

// A line a tenth above the largest peak that was measured per pixel (docs/batch.md): 20 photos of 640x480 with all
// classes.
constexpr uint64_t kFixedBytes = 400'000'000;
constexpr uint64_t kBytesPerPixel = 450;
constexpr double kEarlierPeakFactor = 1.1;  // a second run of a room peaks within a tenth of the first

NetworkInput reduced(int64_t width, int64_t height, int64_t longest) {
  const int64_t side = std::max(width, height);
  if (side <= longest) return {width, height};
  return {width * longest / side, height * longest / side};
}

}  // namespace

uint64_t estimated_training_bytes(uint64_t pixels) { return kFixedBytes + kBytesPerPixel * pixels; }

std::vector<NetworkInput> sizes_of_photos(const fs::path& source, int longest) {
  std::error_code error;
  const fs::path folder = fs::is_directory(source / "images", error) ? source / "images" : source;
  std::vector<NetworkInput> photos;
  for (fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error), end;
       entry != end; entry.increment(error)) {
    if (!entry->is_regular_file(error)) continue;
    try {
      const ImageInfo info = read_image_info(entry->path());
      photos.push_back(reduced(info.width, info.height, longest));
    } catch (const Error&) {
      // No picture, or one that the run will name.
    }
  }
  return photos;
}

uint64_t pixels_of(const std::vector<NetworkInput>& photos) {
  uint64_t pixels = 0;
  for (const NetworkInput& photo : photos) pixels += uint64_t(photo.width) * uint64_t(photo.height);
  return pixels;
}

std::optional<RunRecord> earlier_run(const fs::path& run) {
  const RunFolder folder(run);
  if (!folder.has_run()) return std::nullopt;
  return read_run_record(folder.record());
}

uint64_t expected_peak_bytes(const std::optional<RunRecord>& earlier) {
  if (!earlier) return 0;
  return static_cast<uint64_t>(kEarlierPeakFactor * static_cast<double>(earlier->train.peak_memory_bytes));
}

}  // namespace aligngs
