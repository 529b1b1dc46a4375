#include "synth/teacher_cloud.h"

#include <algorithm>

#include "core/quantile.h"

namespace aligngs {
namespace {

constexpr size_t kMaxCloudPoints = 30000;  // as clouds of VGGT are thinned, at random
constexpr double kCloudQuantile = 0.35;    // pixels below are left out of the cloud

struct Pick {
  size_t view;
  uint32_t pixel;
};

void pick_confident(const TeacherView& teacher, size_t view, std::vector<Pick>& picks) {
  std::vector<float> known;
  for (const float c : teacher.confidence.data) {
    if (c > 0) known.push_back(c);
  }
  if (known.empty()) return;
  const float least = lower_rank_of(std::move(known), kCloudQuantile);
  for (uint32_t p = 0; p < teacher.confidence.data.size(); ++p) {
    if (teacher.depth.data[p] > 0 && teacher.confidence.data[p] >= least) picks.push_back({view, p});
  }
}

}  // namespace

PointCloud teacher_cloud(const std::vector<TeacherCloudView>& views, Random random) {
  std::vector<Pick> picks;
  for (size_t i = 0; i < views.size(); ++i) pick_confident(*views[i].teacher, i, picks);
  const size_t count = std::min(kMaxCloudPoints, picks.size());
  for (size_t i = 0; i < count; ++i) {  // the first `count` places of a random permutation
    const size_t j = i + static_cast<size_t>(random.below(static_cast<int>(picks.size() - i)));
    std::swap(picks[i], picks[j]);
  }
  PointCloud cloud;
  for (size_t i = 0; i < count; ++i) {
    const TeacherCloudView& view = views[picks[i].view];
    const Camera& camera = view.teacher->camera;
    const int x = static_cast<int>(picks[i].pixel) % camera.width, y = static_cast<int>(picks[i].pixel) / camera.width;
    cloud.positions.push_back(camera.unproject(x + 0.5, y + 0.5, view.teacher->depth.at(x, y)).cast<float>());
    const uint8_t* c = view.image->pixel(x, y);
    cloud.colors.push_back(
        {static_cast<float>(c[0]) / 255, static_cast<float>(c[1]) / 255, static_cast<float>(c[2]) / 255});
  }
  return cloud;
}

}  // namespace aligngs
