#include "cli/report/same_room.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "core/median.h"
#include "io/image_file.h"
#include "train/run_record.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr int kSide = 8;              // squares of a thumbnail in each direction
constexpr size_t kMostPhotos = 5;     // pairs that are looked at
constexpr double kOtherPhoto = 0.06;  // of full scale: a photo cut or bent otherwise differs by less in the mean

using Thumbnail = std::array<double, kSide * kSide>;

/// Mean brightness per square, 0 to 1.
Thumbnail thumbnail_of(const Image<uint8_t>& picture) {
  Thumbnail sum{}, count{};
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const auto square = static_cast<size_t>(y * kSide / picture.height * kSide + x * kSide / picture.width);
      for (int c = 0; c < picture.channels; ++c) {
        sum[square] += picture.at(x, y, c) / 255.0;
        count[square] += 1;
      }
    }
  }
  for (size_t i = 0; i < sum.size(); ++i) sum[i] /= std::max(1.0, count[i]);
  return sum;
}

double gap_of(const Thumbnail& a, const Thumbnail& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += std::fabs(a[i] - b[i]);
  return sum / static_cast<double>(a.size());
}

/// Empty where it cannot be read.
std::optional<RunRecord> record_of(const RunScores& run) {
  const fs::path record = run.folder / "run.json";
  return is_run_record(record) ? std::optional(read_run_record(record)) : std::nullopt;
}

/// The photo as the run has it, else that of its scene. An empty path: neither is there.
fs::path photo_of(const RunScores& run, const std::string& view) {
  fs::path drawn = run.folder / "renders" / "test" / "gt" / (view + ".png");
  if (fs::exists(drawn)) return drawn;
  const std::optional<RunRecord> record = record_of(run);
  if (!record) return {};
  const fs::path images = scene_of_run(run.folder, *record) / "images";
  for (const char* ending : {".png", ".jpg", ".jpeg", ".JPG"}) {
    if (fs::exists(images / (view + ending))) return images / (view + ending);
  }
  return {};
}

/// Empty where the record cannot be read: then the photos decide.
std::string scene_mark(const RunScores& run) {
  const std::optional<RunRecord> record = record_of(run);
  return record ? record->fingerprint : std::string();
}

bool shows_other_room(const RunScores& base, const RunScores& run) {
  const std::string mark = scene_mark(run);
  if (!mark.empty() && mark == scene_mark(base)) return false;
  std::vector<double> gaps;
  for (const TestViewMetrics& view : run.views) {
    const fs::path a = photo_of(base, view.name), b = photo_of(run, view.name);
    if (gaps.size() >= kMostPhotos || a.empty() || b.empty()) continue;
    gaps.push_back(gap_of(thumbnail_of(read_image(a)), thumbnail_of(read_image(b))));
  }
  return !gaps.empty() && median_of(std::move(gaps)) > kOtherPhoto;
}

}  // namespace

void mark_other_rooms(std::vector<RunScores>& runs) {
  for (size_t i = 1; i < runs.size(); ++i) runs[i].other_room = shows_other_room(runs[0], runs[i]);
}

}  // namespace aligngs
