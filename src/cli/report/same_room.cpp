#include "cli/report/same_room.h"

#include <algorithm>
#include <array>
#include <cmath>

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

/// A run as far as its photos go.
struct ShownRoom {
  fs::path drawn;     ///< photos as the run has them
  fs::path images;    ///< those of its scene; empty where the record cannot be read
  std::string scene;  ///< mark of the scene; empty likewise: then the photos decide
};

ShownRoom shown_room(const RunScores& run) {
  ShownRoom out{run.folder / "renders" / "test" / "gt", {}, {}};
  const fs::path file = run.folder / "run.json";
  if (!is_run_record(file)) return out;
  const RunRecord record = read_run_record(file);
  out.images = scene_of_run(run.folder, record) / "images";
  out.scene = record.fingerprint;
  return out;
}

/// An empty path: neither the run nor its scene has the photo.
fs::path photo_of(const ShownRoom& room, const std::string& view) {
  if (fs::exists(room.drawn / (view + ".png"))) return room.drawn / (view + ".png");
  if (room.images.empty()) return {};
  for (const char* ending : {".png", ".jpg", ".jpeg", ".JPG"}) {
    if (fs::exists(room.images / (view + ending))) return room.images / (view + ending);
  }
  return {};
}

bool shows_other_room(const ShownRoom& base, const RunScores& run) {
  const ShownRoom room = shown_room(run);
  if (!room.scene.empty() && room.scene == base.scene) return false;
  std::vector<double> gaps;
  for (const TestViewMetrics& view : run.views) {
    if (gaps.size() >= kMostPhotos) break;
    const fs::path a = photo_of(base, view.name), b = photo_of(room, view.name);
    if (a.empty() || b.empty()) continue;
    gaps.push_back(gap_of(thumbnail_of(read_image(a)), thumbnail_of(read_image(b))));
  }
  return !gaps.empty() && median_of(std::move(gaps)) > kOtherPhoto;
}

}  // namespace

void mark_other_rooms(std::vector<RunScores>& runs) {
  if (runs.size() < 2) return;
  const ShownRoom base = shown_room(runs[0]);
  for (size_t i = 1; i < runs.size(); ++i) runs[i].other_room = shows_other_room(base, runs[i]);
}

}  // namespace aligngs
