#include "refine/screens.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <set>

#include "core/median.h"
#include "refine/screen_photos.h"

namespace aligngs {
namespace {

constexpr int kFine = 4;         // parts of a step that the best plane is looked for in
constexpr double kTail = 0.03;   // of an outline's points on each side that a rectangle does not follow
constexpr int kShownStride = 2;  // pixels between those that a region and a rectangle are compared at

using Regions = std::vector<ScreenRegion>;

/// The rectangle of outlines on a plane: each side where half of the photos have it farther out.
Panel rectangle(const ScreenPhotos& photos, const Regions& regions, const std::vector<size_t>& of,
                const WorldPlane& plane) {
  Panel panel;
  panel.normal = plane.normal;
  panel.offset = plane.offset;
  set_upright(panel, photos.planes);
  std::vector<double> low[2], high[2], depths;
  for (const size_t i : of) {
    const std::vector<Vec3d> points = on_plane(regions[i].outline, photos.camera(regions[i]), plane);
    if (points.empty()) continue;
    panel.points += points.size();
    ++panel.views;
    depths.push_back(photos.depth_on(regions[i], plane));
    for (int k = 0; k < 2; ++k) {
      std::vector<double> along;
      for (const Vec3d& p : points) along.push_back(dot(k == 0 ? panel.across : panel.up, p));
      std::sort(along.begin(), along.end());
      const size_t tail = static_cast<size_t>(kTail * static_cast<double>(along.size()));
      low[k].push_back(along[tail]);
      high[k].push_back(along[along.size() - 1 - tail]);
    }
  }
  for (int k = 0; k < 2; ++k) {
    panel.low[k] = median_of(std::move(low[k]));
    panel.high[k] = median_of(std::move(high[k]));
  }
  panel.depth = median_of(std::move(depths));
  return panel;
}

/// Whether a region is the panel as its photo shows it.
bool shows(const ScreenPhotos& photos, const ScreenRegion& region, const Panel& panel) {
  const Camera& camera = photos.camera(region);
  const Vec3d centre = camera.centre();
  const double distance = panel.distance(centre);
  if (!(distance > 0)) return false;
  size_t both = 0, either = 0;
  for (int y = 0; y < region.inside.height; y += kShownStride) {
    for (int x = 0; x < region.inside.width; x += kShownStride) {
      const Vec3d ray = ray_in_world(camera, x + 0.5, y + 0.5);
      const double slope = -dot(panel.normal, ray);
      const bool hit = slope > 0 && panel.contains(centre + ray * (distance / slope)),
                 inside = region.inside.at(x, y) != 0;
      both += hit && inside;
      either += hit || inside;
    }
  }
  return static_cast<double>(both) > photos.settings.same * static_cast<double>(either);
}

/// A plane for a screen, judged in all photos of it.
struct Placement {
  Panel panel;
  std::vector<size_t> regions;  ///< of the photos that show it
  double agreement = 0;         ///< mean over them
  double supported = 0;
  double score() const { return agreement + supported; }
  double total() const { return agreement * static_cast<double>(regions.size()) + supported; }
};

/// Places screens one after the other.
class Placer {
 public:
  Placer(const ScreenPhotos& photos, const Regions& regions, const ScreenSupport& support)
      : photos_(photos), regions_(regions), support_(support) {}

  /// A plane that came from one region, for it and those of `left` that show the same rectangle.
  Placement judge(const std::vector<size_t>& left, size_t first, const WorldPlane& plane) const {
    const Panel panel = rectangle(photos_, regions_, {first}, plane);
    Placement out;
    for (const size_t i : left) {
      if (i == first || shows(photos_, regions_[i], panel)) out.regions.push_back(i);
    }
    out.agreement = photos_.mean_agreement(regions_, out.regions, plane);
    complete(plane, out);
    return out;
  }

  /// The same with the plane moved to where all its photos agree best.
  Placement refine(Placement placement) const {
    const ScreenRegion& first = regions_[placement.regions.front()];
    const WorldPlane start{placement.panel.normal, placement.panel.offset};
    const double depth = photos_.depth_on(first, start), step = photos_.log_step() / kFine;
    WorldPlane best = start;
    for (int k = -2 * kFine; k <= 2 * kFine; ++k) {
      const WorldPlane plane = photos_.plane_at(first, start.normal, depth * std::exp(k * step));
      const double agreement = photos_.mean_agreement(regions_, placement.regions, plane);
      if (agreement <= placement.agreement) continue;
      placement.agreement = agreement;
      best = plane;
    }
    complete(best, placement);
    return placement;
  }

  /// Whether the plane beats the screen's current place by a margin. The mean is over its photos, or over those of them
  /// that have it on a panel.
  bool beats_today(const Placement& placement, const std::vector<Panel>& panels) const {
    double all = 0, on_panels = 0;
    size_t count = 0;
    for (const size_t i : placement.regions) {
      const std::vector<size_t> known = panels_of(regions_[i], panels);
      double today = 0;
      for (const size_t k : known) today = std::max(today, score(i, {panels[k].normal, panels[k].offset}));
      for (const Vec3d& normal : known.empty() ? photos_.normals_for(regions_[i]) : std::vector<Vec3d>{}) {
        today = std::max(today, score(i, photos_.plane_at(regions_[i], normal, regions_[i].depth)));
      }
      all += today;
      on_panels += known.empty() ? 0 : today;
      count += known.empty() ? 0 : 1;
    }
    const double least = placement.score() - photos_.settings.margin;
    return all < least * static_cast<double>(placement.regions.size()) ||
           (count > 0 && on_panels < least * static_cast<double>(count));
  }

  /// The panel takes the place of those that a photo had the screen on and that are worse by the margin.
  void replace(const Placement& placement, std::vector<Panel>& panels) const {
    std::set<size_t> worse;
    for (const size_t i : placement.regions) {
      for (const size_t k : panels_of(regions_[i], panels)) {
        if (score(i, {panels[k].normal, panels[k].offset}) < placement.score() - photos_.settings.margin)
          worse.insert(k);
      }
    }
    for (auto k = worse.rbegin(); k != worse.rend(); ++k)
      panels.erase(panels.begin() + static_cast<std::ptrdiff_t>(*k));
    panels.push_back(placement.panel);
  }

 private:
  double supported(const Panel& panel) const {
    return support_.hangs(panel) || support_.stands(panel) ? photos_.settings.supported : 0;
  }

  /// Result of one region alone.
  double score(size_t region, const WorldPlane& plane) const {
    return photos_.agreement_of(regions_[region], plane) + supported(rectangle(photos_, regions_, {region}, plane));
  }

  void complete(const WorldPlane& plane, Placement& placement) const {
    placement.panel = rectangle(photos_, regions_, placement.regions, plane);
    placement.supported = supported(placement.panel);
  }

  /// Panels that the middle of a region lies on.
  std::vector<size_t> panels_of(const ScreenRegion& region, const std::vector<Panel>& panels) const {
    std::vector<size_t> out;
    for (size_t k = 0; k < panels.size(); ++k) {
      const double depth = photos_.depth_on(region, {panels[k].normal, panels[k].offset});
      if (depth > 0 && panels[k].contains(photos_.middle_at(region, depth))) out.push_back(k);
    }
    return out;
  }

  const ScreenPhotos& photos_;
  const Regions& regions_;
  const ScreenSupport& support_;
};

template <class Work>
void for_each(size_t count, ThreadPool& pool, const Work& work) {
  pool.parallel_for(count, 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) work(i);
  });
}

}  // namespace

std::vector<Panel> place_screens(const std::vector<PlaneView>& views, const std::vector<const ImageF*>& lumas,
                                 const std::vector<PanelClass>& classes, const std::vector<ScenePlane>& planes,
                                 std::vector<Panel> panels, const ScreenSettings& settings, ThreadPool& pool) {
  ScreenPhotos photos{views, planes, settings, std::vector<ImageF>(views.size())};
  std::vector<Regions> per_view(views.size());
  for_each(views.size(), pool, [&](size_t v) {
    photos.gradients[v] = luma_gradient(*lumas[v]);
    per_view[v] = screen_regions(views[v], v, photos.gradients[v], classes, settings.regions);
  });
  Regions regions;
  for (Regions& list : per_view) std::move(list.begin(), list.end(), std::back_inserter(regions));
  if (regions.empty()) return panels;

  const ScreenSupport support(views, classes, planes, settings.support, pool);
  const Placer placer(photos, regions, support);
  std::vector<std::vector<WorldPlane>> tried(regions.size());
  for_each(regions.size(), pool, [&](size_t i) { tried[i] = photos.candidates(regions[i]); });
  std::vector<size_t> left(regions.size());
  std::iota(left.begin(), left.end(), size_t(0));
  while (!left.empty()) {
    std::vector<Placement> best(left.size());
    for_each(left.size(), pool, [&](size_t k) {
      for (const WorldPlane& plane : tried[left[k]]) {
        Placement placement = placer.judge(left, left[k], plane);
        if (placement.total() > best[k].total()) best[k] = std::move(placement);
      }
    });
    const auto most = std::max_element(best.begin(), best.end(),
                                       [](const Placement& a, const Placement& b) { return a.total() < b.total(); });
    if (most->regions.empty()) break;  // no plane has anybody's agreement
    const Placement placement = placer.refine(std::move(*most));
    const bool held = placement.supported > 0 || !settings.must_be_supported;
    if (held && placement.agreement >= settings.least_agreement && placer.beats_today(placement, panels))
      placer.replace(placement, panels);
    std::erase_if(left, [&](size_t i) {
      return std::find(placement.regions.begin(), placement.regions.end(), i) != placement.regions.end();
    });
  }
  return panels;
}

}  // namespace aligngs
