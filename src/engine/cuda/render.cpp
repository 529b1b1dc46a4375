// Rendering any camera, and the closed-form start of the semantic rows.
#include "engine/cuda/blend_forward.h"
#include "engine/cuda/cuda_engine.h"
#include "engine/cuda/finish_maps.h"
#include "engine/cuda/label_map.h"
#include "engine/cuda/semantic_lift.h"
#include "scene/triangle_mesh.h"

namespace aligngs::cuda {

Rendering CudaEngine::render(const Camera& camera, const RenderOptions& options) const {
  const bool labels = options.labels && model_.channels() > 0;
  const DeviceFrame frame = make_frame({camera, options.raster, sh_degree_, options.geometry, labels});
  blend_forward(*context_, {frame.view, frame.lists, options.raster, options.geometry}, frame.maps, frame.record);
  const int w = frame.view.width, h = frame.view.height;
  const size_t pixels = frame.maps.alpha.size;
  FinishedMaps finished;
  finished.color = arena_.take<float>(3 * pixels, "rendered colour");
  if (options.geometry) {
    finished.normal = arena_.take<float>(3 * pixels, "rendered normals");
    finished.depth_plane = arena_.take<float>(pixels, "rendered depth");
    finished.depth_expected = arena_.take<float>(pixels, "rendered depth");
  }
  finish_maps(*context_, frame.view, frame.maps, finished);

  Rendering r;
  r.color = ImageF(w, h, 3);
  r.alpha = ImageF(w, h, 1);
  download(*context_, r.color.data.data(), finished.color);
  download(*context_, r.alpha.data.data(), frame.maps.alpha);
  if (options.geometry) {
    r.normal = ImageF(w, h, 3);
    r.depth_plane = r.depth_median = r.depth_expected = ImageF(w, h, 1);
    download(*context_, r.normal.data.data(), finished.normal);
    download(*context_, r.depth_plane.data.data(), finished.depth_plane);
    download(*context_, r.depth_expected.data.data(), finished.depth_expected);
    download(*context_, r.depth_median.data.data(), frame.maps.median);
  }
  if (!labels) return r;

  const LabelOutputs out{arena_.take<uint16_t>(pixels, "labels"), arena_.take<float>(pixels, "labels")};
  label_map(arena_,
            {model_.spans(), frame.view, frame.lists, frame.record, frame.maps.alpha, options.raster,
             options.semantic_blend, map_.remainder()},
            out);
  r.label = Image<uint16_t>(w, h, 1, kNoLabel);
  r.label_probability = ImageF(w, h, 1);
  download(*context_, r.label.data.data(), out.channel);
  download(*context_, r.label_probability.data.data(), out.probability);
  if (!map_.has_remainder()) return r;
  for (uint16_t& label : r.label.data) {
    if (label != kNoLabel) label = map_.active[label];
  }
  return r;
}

void CudaEngine::lift_semantics(const RasterSettings& raster) {
  const size_t channels = static_cast<size_t>(model_.channels()), n = model_.size();
  if (channels == 0) return;
  last_ = {};
  DeviceArray<float> sums(*context_, n * channels, "sums of the teachers");
  fill_zero(*context_, sums.span());
  for (const ViewOnDevice& view : views_) {
    if (view.teacher_channels != model_.channels()) continue;
    if (map_.remainder() != active_.remainder()) continue;  // a model of another number of classes
    const DeviceFrame frame = make_frame({view.camera, raster, sh_degree_, false, true});
    blend_forward(*context_, {frame.view, frame.lists, raster, false}, frame.maps, frame.record);
    add_teacher_sums(arena_, {frame.view, frame.lists, frame.record, view.teacher.spans(), raster}, sums.span());
  }
  start_semantic_rows(*context_, sums.span(), map_.remainder(), model_.spans());
  fill_zero(*context_, m_.spans().semantics);
  fill_zero(*context_, v_.spans().semantics);
  fill_zero(*context_, semantic_updates_.span());
  context_->synchronise();  // the sums are gone on return
}

}  // namespace aligngs::cuda
