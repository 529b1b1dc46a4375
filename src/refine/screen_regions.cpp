#include "refine/screen_regions.h"

#include <cmath>
#include <map>

#include "core/disjoint_sets.h"
#include "core/median.h"
#include "scene/plane_fit.h"

namespace aligngs {
namespace {

/// 4-connected regions of what is called a screen, by their first pixels.
std::map<uint32_t, ScreenRegion> connected(const Image<uint16_t>& labels, const std::vector<PanelClass>& classes) {
  const int width = labels.width, height = labels.height;
  const auto is_screen = [&](int x, int y) {
    const uint16_t label = labels.at(x, y);
    return label < classes.size() && classes[label] == PanelClass::kScreen;
  };
  const auto index = [&](int x, int y) { return static_cast<uint32_t>(y * width + x); };
  DisjointSets sets(labels.pixels());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (!is_screen(x, y)) continue;
      if (x + 1 < width && is_screen(x + 1, y)) sets.unite(index(x, y), index(x + 1, y));
      if (y + 1 < height && is_screen(x, y + 1)) sets.unite(index(x, y), index(x, y + 1));
    }
  }
  std::map<uint32_t, ScreenRegion> regions;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (!is_screen(x, y)) continue;
      ScreenRegion& region = regions[sets.find(index(x, y))];
      if (region.pixels++ == 0) region.inside = Image<uint8_t>(width, height, 1);
      region.inside.at(x, y) = 1;
      region.centre.x += x + 0.5;
      region.centre.y += y + 0.5;
    }
  }
  return regions;
}

/// Sets depth and normal; false where fewer than half of the pixels have depth.
bool measure_today(const PlaneView& view, ScreenRegion& region) {
  std::vector<double> depths;
  std::vector<Vec3d> points;
  const Rigidd to_world = view.camera.world_to_camera.inverse();
  for (int y = 0; y < region.inside.height; ++y) {
    for (int x = 0; x < region.inside.width; ++x) {
      const double z = view.depth.at(x, y);
      if (!region.inside.at(x, y) || !(z > 0) || !std::isfinite(z)) continue;
      depths.push_back(z);
      points.push_back(to_world * (view.camera.ray(x + 0.5, y + 0.5) * z));
    }
  }
  if (points.empty() || 2 * points.size() < region.pixels) return false;
  region.depth = median_of(std::move(depths));
  region.normal = fit_plane(points, {}, to_world.translation - points[points.size() / 2]).normal;
  return true;
}

}  // namespace

std::vector<ScreenRegion> screen_regions(const PlaneView& view, size_t index, const ImageF& gradient,
                                         const std::vector<PanelClass>& classes, const ScreenRegionSettings& settings) {
  if (view.labels.empty() || view.depth.empty()) return {};
  std::vector<ScreenRegion> out;
  for (auto& [first, region] : connected(view.labels, classes)) {
    const double pixels = static_cast<double>(region.pixels);
    if (pixels < settings.least_pixels * static_cast<double>(view.labels.pixels())) continue;
    region.view = index;
    region.centre = {region.centre.x / pixels, region.centre.y / pixels};
    region.outline = outline_of(region.inside, gradient, settings.outline);
    if (region.outline.size() >= settings.least_outline && measure_today(view, region))
      out.push_back(std::move(region));
  }
  return out;
}

}  // namespace aligngs
