// For tests: the box room of refine/testing/box_room.h as Gaussians.
#pragma once

#include "gaussians/initialise.h"
#include "refine/testing/box_room.h"
#include "scene/voxel_merge.h"

namespace aligngs::box_room {

inline LabelSet room_labels() {
  LabelSet labels;
  for (const char* name : {"wall", "floor", "ceiling", "chest"}) labels.classes.push_back({name, {}, {}});
  return labels;
}

inline uint16_t label_at(const Vec3f& p) {
  if (p.x < kChestHigh.x + 0.03 && p.x > kChestLow.x - 0.03 && p.z > kChestLow.z - 0.03 && p.z < kChestHigh.z + 0.03 &&
      p.y > kChestLow.y - 0.03 && p.y < kFloor - 0.03) {
    return kChestLabel;
  }
  return p.y > kFloor - 0.03 ? kFloorLabel : p.y < kCeiling + 0.03 ? kCeilingLabel : kWallLabel;
}

/// Points of the photos, a point for each pixel of every `stride` rows and columns.
inline PointCloud shown_points(int stride) {
  PointCloud cloud;
  for (const LayoutView& view : photos()) {
    for (int y = stride / 2; y < view.plane.camera.height; y += stride) {
      for (int x = stride / 2; x < view.plane.camera.width; x += stride) {
        cloud.positions.push_back(
            view.plane.camera.unproject(x + 0.5, y + 0.5, view.plane.depth.at(x, y)).cast<float>());
        cloud.colors.push_back(kColors[view.plane.labels.at(x, y)]);
      }
    }
  }
  return cloud;
}

/// Gaussians on all that the photos show, as training leaves them; `logit` is that of their class.
inline GaussianModel trained_room(int channels = 4, float logit = 6) {
  InitialiseOptions options;
  options.semantic_channels = channels;
  options.opacity = 0.9f;
  GaussianModel model = initialise_gaussians(voxel_thin(shown_points(1), 0.03), options);
  for (size_t i = 0; channels > 0 && i < model.size(); ++i) {
    const float* p = &model.positions[3 * i];
    model.semantics[i * static_cast<size_t>(channels) + label_at({p[0], p[1], p[2]})] = logit;
  }
  return model;
}

}  // namespace aligngs::box_room
