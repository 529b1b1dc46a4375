#include "refine/panel_depth.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/disjoint_sets.h"

namespace aligngs {
namespace {

constexpr uint64_t kPanelSeed = 1;  // the same panels every time

struct NamedPanelClass {
  const char* name;
  PanelClass what;
};
// Blinds and pictures are here for what they are mistaken for as much as for themselves: whatever is not flat makes no
// panel.
constexpr NamedPanelClass kNamedPanelClasses[] = {
    {"windowpane", PanelClass::kInWall},     {"painting", PanelClass::kInWall},   {"poster", PanelClass::kInWall},
    {"bulletin board", PanelClass::kInWall}, {"blind", PanelClass::kInWall},      {"screen", PanelClass::kInWall},
    {"mirror", PanelClass::kFree},           {"television", PanelClass::kScreen}, {"monitor", PanelClass::kScreen},
    {"crt screen", PanelClass::kScreen},
};

PanelClass class_at(const PlaneView& view, const std::vector<PanelClass>& classes, int x, int y) {
  const uint16_t label = view.labels.at(x, y);
  return label < classes.size() ? classes[label] : PanelClass::kNone;
}

/// H x W, 1 where something is called a panel.
Image<uint8_t> mask_of(const PlaneView& view, const std::vector<PanelClass>& classes) {
  Image<uint8_t> mask(view.labels.width, view.labels.height, 1);
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) mask.at(x, y) = class_at(view, classes, x, y) != PanelClass::kNone;
  }
  return mask;
}

/// At a wall: neither inside of the room nor outside. A room without walls may have them anywhere.
bool in_wall(const Vec3d& position, double depth, const std::vector<ScenePlane>& planes, const PanelDepthSettings& s) {
  bool any = false;
  for (const ScenePlane& plane : planes) {
    if (plane.kind != PlaneKind::kWall) continue;
    any = true;
    const double distance = plane.distance(position) / depth;
    if (distance < s.before_wall && distance > -s.behind_wall) return true;
  }
  return !any;
}

/// 4-connected regions of a mask.
DisjointSets regions(const Image<uint8_t>& mask) {
  DisjointSets sets(mask.data.size());
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      const auto i = static_cast<uint32_t>(y * mask.width + x);
      if (!mask.data[i]) continue;
      if (x + 1 < mask.width && mask.data[i + 1]) sets.unite(i, i + 1);
      const auto below = i + static_cast<uint32_t>(mask.width);
      if (y + 1 < mask.height && mask.data[below]) sets.unite(i, below);
    }
  }
  return sets;
}

bool has_maps(const PlaneView& view) { return !view.labels.data.empty() && !view.depth.empty(); }

/// The panels as one camera sees them: how deep the ray of a pixel meets them.
class PanelsInView {
 public:
  PanelsInView(const std::vector<Panel>& panels, const std::vector<uint8_t>& in_wall, const Camera& camera)
      : panels_(panels), in_wall_(in_wall), camera_(camera), centre_(camera.centre()) {}

  Vec3d ray(int x, int y) const {
    return transpose_times(camera_.world_to_camera.rotation, camera_.ray(x + 0.5, y + 0.5));
  }
  /// Depth of a panel along a ray; 0 beside it and from behind.
  double depth(size_t panel, const Vec3d& ray) const {
    const double distance = panels_[panel].distance(centre_), slope = -dot(panels_[panel].normal, ray);
    if (!(distance > 0) || !(slope > 0)) return 0;
    return panels_[panel].contains(centre_ + ray * (distance / slope)) ? distance / slope : 0;
  }
  size_t count() const { return panels_.size(); }
  bool can_be(size_t panel, PanelClass c) const {
    return c == PanelClass::kFree || c == PanelClass::kScreen || (c == PanelClass::kInWall && in_wall_[panel]);
  }

 private:
  const std::vector<Panel>& panels_;
  const std::vector<uint8_t>& in_wall_;
  const Camera& camera_;
  Vec3d centre_;
};

constexpr int32_t kNobody = -1;

/// Panel of each pixel of the mask, by the nearest measured pixel along the mask; kNobody where its region has none.
Image<int32_t> owners(const PanelsInView& panels, const PlaneView& view, const std::vector<PanelClass>& classes,
                      const Image<uint8_t>& mask, const PanelDepthSettings& s) {
  Image<int32_t> owner(mask.width, mask.height, 1);
  std::fill(owner.data.begin(), owner.data.end(), kNobody);
  std::vector<std::pair<int, int>> queue;  // breadth first
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      const double z = view.depth.at(x, y);
      if (!mask.at(x, y) || view.certainty.empty() || !(view.certainty.at(x, y) >= s.least_certainty) || !(z > 0))
        continue;
      double least = s.off;
      const Vec3d ray = panels.ray(x, y);
      for (size_t k = 0; k < panels.count(); ++k) {
        if (!panels.can_be(k, class_at(view, classes, x, y))) continue;
        const double depth = panels.depth(k, ray), off = depth > 0 ? std::abs(std::log(depth / z)) : least;
        if (off >= least) continue;
        least = off;
        owner.at(x, y) = static_cast<int32_t>(k);
      }
      if (owner.at(x, y) != kNobody) queue.emplace_back(x, y);
    }
  }
  constexpr int kSteps[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  for (size_t next = 0; next < queue.size(); ++next) {
    const auto [x, y] = queue[next];
    for (const auto& step : kSteps) {
      const int nx = x + step[0], ny = y + step[1];
      if (nx < 0 || ny < 0 || nx >= mask.width || ny >= mask.height || !mask.at(nx, ny) || owner.at(nx, ny) != kNobody)
        continue;
      if (!panels.can_be(static_cast<size_t>(owner.at(x, y)), class_at(view, classes, nx, ny))) continue;
      owner.at(nx, ny) = owner.at(x, y);
      queue.emplace_back(nx, ny);
    }
  }
  return owner;
}

/// Depth of the panel that a pixel is of; 0: of none.
double panel_depth(const PanelsInView& panels, int32_t owner, PanelClass what, const Vec3d& ray) {
  if (owner != kNobody) return panels.depth(static_cast<size_t>(owner), ray);
  double nearest = 0;
  for (size_t k = 0; k < panels.count(); ++k) {
    const double depth = panels.can_be(k, what) ? panels.depth(k, ray) : 0;
    if (depth > 0 && (nearest == 0 || depth < nearest)) nearest = depth;
  }
  return nearest;
}

/// Whether another photo confirms that the pixel is not of a panel so far off.
bool is_elsewhere(const PlaneView& view, int x, int y, double log_factor, const PanelDepthSettings& s) {
  return !view.certainty.empty() && view.certainty.at(x, y) >= s.sure && std::abs(log_factor) > s.off;
}

void measure_view(const PanelsInView& panels, const std::vector<CameraPlane>& planes, const PlaneView& view,
                  const std::vector<PanelClass>& classes, const PanelDepthSettings& s, PlaneMeasurement& out) {
  const Image<uint8_t> mask = interior(mask_of(view, classes), s.label_edge);
  const Image<int32_t> owner = owners(panels, view, classes, mask, s);
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      const double z = view.depth.at(x, y);
      if (!mask.at(x, y) || !(z > 0) || !std::isfinite(z)) continue;
      double depth = panel_depth(panels, owner.at(x, y), class_at(view, classes, x, y), panels.ray(x, y));
      if (depth == 0) {
        const Vec3d ray = view.camera.ray(x + 0.5, y + 0.5);
        const CameraPlane* wall = first_on_ray(planes, PlaneKind::kWall, ray);
        if (wall && std::log(z / wall->depth(ray)) > s.off) depth = wall->depth(ray);
      }
      const double log_factor = depth > 0 ? std::log(depth / z) : 0;
      if (depth == 0 || is_elsewhere(view, x, y, log_factor, s) || std::abs(log_factor) > s.reach) continue;
      out.log_factor.at(x, y) = static_cast<float>(log_factor);
      out.weight.at(x, y) =
          static_cast<float>(s.strength) * (view.label_share.empty() ? 1.0f : view.label_share.at(x, y));
      out.plane.at(x, y) = 0;
    }
  }
}

}  // namespace

std::vector<PanelClass> panel_classes(const LabelSet& labels) {
  std::vector<PanelClass> out(labels.classes.size());
  for (const NamedPanelClass& named : kNamedPanelClasses) {
    const int index = labels.find(named.name);
    if (index >= 0) out[static_cast<size_t>(index)] = named.what;
  }
  return out;
}

std::vector<Panel> find_panels(const std::vector<PlaneView>& views, const std::vector<PanelClass>& classes,
                               const std::vector<ScenePlane>& planes, const PanelDepthSettings& settings) {
  std::vector<PanelPoint> points;
  uint32_t parts = 0;
  for (size_t v = 0; v < views.size(); ++v) {
    const PlaneView& view = views[v];
    if (!has_maps(view) || view.certainty.empty()) continue;
    const Image<uint8_t> mask = interior(mask_of(view, classes), settings.label_edge);
    DisjointSets sets = regions(mask);
    std::map<uint32_t, uint32_t> numbers;  // of its regions, among those of all photos
    const Vec3d centre = view.camera.centre();
    const int stride = std::max(1, mask.width / settings.sampled_width);
    for (int y = stride / 2; y < mask.height; y += stride) {
      for (int x = stride / 2; x < mask.width; x += stride) {
        const float z = view.depth.at(x, y), certainty = view.certainty.at(x, y);
        if (!mask.at(x, y) || !(z > 0) || !(certainty >= settings.least_certainty)) continue;
        const Vec3d position = view.camera.unproject(x + 0.5, y + 0.5, z);
        if (class_at(view, classes, x, y) == PanelClass::kInWall && !in_wall(position, z, planes, settings)) continue;
        const uint32_t region = sets.find(static_cast<uint32_t>(y * mask.width + x));
        const uint32_t part = numbers.try_emplace(region, parts + static_cast<uint32_t>(numbers.size())).first->second;
        points.push_back({position, centre, z, certainty, static_cast<int>(v), part});
      }
    }
    parts += static_cast<uint32_t>(numbers.size());
  }
  return find_panels(points, planes, settings.panels, kPanelSeed);
}

void measure_on_panels(const std::vector<Panel>& panels, const std::vector<ScenePlane>& planes,
                       const std::vector<PlaneView>& views, const std::vector<PanelClass>& classes,
                       const PanelDepthSettings& s, ThreadPool& pool, std::vector<PlaneMeasurement>& measurements) {
  std::vector<uint8_t> walled;
  for (const Panel& panel : panels) walled.push_back(in_wall(panel.centre(), panel.depth, planes, s));
  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t v = begin; v < end; ++v) {
      if (!has_maps(views[v])) continue;
      measure_view({panels, walled, views[v].camera}, in_frame_of(views[v].camera, planes), views[v], classes, s,
                   measurements[v]);
    }
  });
}

}  // namespace aligngs
