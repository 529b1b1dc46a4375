// The check of a scene's depth maps together: the part of scene_check.h that compares views with each other.
#include <algorithm>

#include "core/error.h"
#include "core/is_depth.h"
#include "io/exif_orientation.h"
#include "scene/depth_contradiction.h"
#include "scene/prior_maps.h"
#include "scene/scene_check.h"

namespace aligngs {
namespace {

constexpr size_t kMostMaps = 24;   ///< evenly spread: more tell nothing new
constexpr int kMostColumns = 320;  ///< of a map that is compared; its samples are farther apart than that

/// A map as it is compared: no larger than needed, 0 where there is no depth. Empty where the file cannot be used.
ImageF compared_map(const std::filesystem::path& file) {
  try {
    const FloatArray array = read_map(file);
    const MapShape shape = depth_map_shape(array.shape, file);
    const int step = (shape.width + kMostColumns - 1) / kMostColumns;
    ImageF map(std::max(1, shape.width / step), std::max(1, shape.height / step), 1, 0.f);
    for (int y = 0; y < map.height; ++y) {
      for (int x = 0; x < map.width; ++x) {
        const size_t column = static_cast<size_t>((x + 0.5) * shape.width / map.width);
        const size_t row = static_cast<size_t>((y + 0.5) * shape.height / map.height);
        const float z = array.data[row * static_cast<size_t>(shape.width) + column];
        if (is_depth(z)) map.at(x, y) = z;
      }
    }
    return map;
  } catch (const Error&) {
    return {};  // its view's own check tells why
  }
}

}  // namespace

std::optional<std::string> turned_map(const PointCloud& cloud, const Camera& camera, const ImageF& prior_depth) {
  constexpr double kFits = 0.9;  // rank correlation: depth that is right has more with points that are good
  if (disparity_evidence(cloud, camera, prior_depth).rank_correlation < -kFits) return {};
  struct Way {
    const char* name;
    int orientation;  // as EXIF counts
  };
  std::optional<std::string> found;
  double best = kFits;
  for (const Way& way : {Way{"upside down", 4}, Way{"mirrored", 2}, Way{"turned by 180 degrees", 3}}) {
    const DisparityEvidence evidence =
        disparity_evidence(cloud, camera, apply_orientation(prior_depth, way.orientation));
    if (!evidence.is_enough() || evidence.rank_correlation <= best) continue;
    best = evidence.rank_correlation;
    found = way.name;
  }
  return found;
}

std::vector<SceneProblem> check_depth_of_views(const Scene& scene) {
  if (scene.depth_scale != DepthScale::kScene || scene.prior_source == kStereoDepth) return {};
  std::vector<const View*> views;
  for (const int index : scene.train) {
    const View& view = scene.views[static_cast<size_t>(index)];
    if (!view.prior_depth.empty()) views.push_back(&view);
  }
  std::vector<Camera> cameras;
  std::vector<ImageF> depths;
  const size_t kept = std::min(views.size(), kMostMaps);
  for (size_t i = 0; i < kept; ++i) {
    const View& view = *views[i * views.size() / kept];
    ImageF map = compared_map(view.prior_depth);
    if (map.empty()) continue;
    cameras.push_back(view.camera.resized(map.width, map.height));
    depths.push_back(std::move(map));
  }
  const auto found = depth_contradiction(cameras, depths, scene.cloud, scene.metric);
  if (!found) return {};
  return {{scene.folder / "pred_depths", kDepthOfViews, found->message,
           found->factor != 1 ? "write it in scene units, or set \"scale\": \"own\" in priors.json"
                              : "compute the maps again, or correct the poses",
           false}};
}

}  // namespace aligngs
