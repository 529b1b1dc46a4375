#include "train/rendered_view.h"

namespace aligngs {
namespace {

constexpr float kSolid = 0.9f;  // alpha from which a pixel's depth counts as one surface's

}  // namespace

Rendering render_labelled(const Engine& engine, const GuideView& view, const Camera& camera, RenderOptions options) {
  options.raster.near_plane = view.near_plane;
  options.geometry = options.labels = true;
  return engine.render(camera, options);
}

PlaneView plane_view_of(const Camera& camera, const Rendering& seen) {
  PlaneView out;
  out.camera = camera;
  out.depth = seen.depth_median;
  out.labels = seen.label;
  out.certainty = ImageF(camera.width, camera.height, 1);
  for (size_t i = 0; i < seen.alpha.data.size(); ++i) out.certainty.data[i] = seen.alpha.data[i] > kSolid ? 1.0f : 0.0f;
  return out;
}

}  // namespace aligngs
