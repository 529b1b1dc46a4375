// For tests: a view that the CPU engine has projected, binned and blended, on the device in the layout of view_spans.h.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "core/thread_pool.h"
#include "device/testing/device.h"
#include "engine/cpu/parameter_gradients.h"
#include "engine/cpu/project.h"
#include "engine/cpu/tile_passes.h"
#include "engine/cuda/model_spans.h"
#include "engine/cuda/view_spans.h"
#include "engine/testing/scenes.h"

namespace aligngs::cuda {

/// A model's arrays on the device.
struct DeviceModel {
  DeviceModel(DeviceContext& context, const GaussianModel& model)
      : gaussians(model.size()), channels(model.semantic_channels) {
    positions.assign(context, model.positions, "test");
    log_scales.assign(context, model.log_scales, "test");
    rotations.assign(context, model.rotations, "test");
    opacity_logits.assign(context, model.opacity_logits, "test");
    sh.assign(context, model.sh, "test");
    semantics.assign(context, model.semantics, "test");
  }
  ModelSpans spans() {
    return {gaussians, channels,        positions.span(), log_scales.span(), rotations.span(), opacity_logits.span(),
            sh.span(), semantics.span()};
  }
  size_t gaussians;
  int channels;
  DeviceArray<float> positions, log_scales, rotations, opacity_logits, sh, semantics;
};

/// The forward half of a step by the CPU engine, and its copy on the device.
class TestView {
 public:
  TestView(DeviceContext& context, const GaussianModel& model, const Camera& camera, const RasterSettings& settings,
           int sh_degree = 3)
      : raster(settings) {
    cpu::project_view(model, camera, raster, sh_degree, pool, view);
    cpu::build_tile_lists(view, pool, lists);
    scratch.resize(static_cast<size_t>(pool.size()));
    cpu::forward_pass({view, lists, raster}, cpu::BlendedMaps::kAll, pool, scratch, maps, &record);
    visible = cpu::mark_touched(lists, record, pool, cpu_gradients.touched);
    upload_view(context);
    upload_record(context);
  }

  ViewSpans view_spans() {
    return {view.camera,  view.width,    view.height,  view.tiles_x,
            view.tiles_y, splats.span(), rects.span(), radius.span()};
  }
  TileListSpans list_spans() { return {slot_begin.span(), tile_begin.span(), gaussians.span(), rank.span()}; }
  BlendRecordSpans record_spans() { return {strips.span(), seen.span(), last.span(), transmittance.span()}; }

  RasterSettings raster;
  ThreadPool pool{1};
  cpu::ProjectedView view;
  cpu::TileLists lists;
  cpu::BlendRecord record;
  RenderMaps<float> maps;
  std::vector<cpu::TileScratch> scratch;
  cpu::ParameterGradients cpu_gradients;  ///< `touched` is filled
  size_t visible = 0;

 private:
  template <class From>
  static auto to_vector(const From& from) {
    return std::vector<std::decay_t<decltype(from.data()[0])>>(from.data(), from.data() + from.size());
  }
  template <class From>
  static std::vector<uint32_t> to_indices(const From& from) {
    return std::vector<uint32_t>(from.data(), from.data() + from.size());
  }

  void upload_view(DeviceContext& context) {
    splats.assign(context, to_vector(view.splats), "test");
    rects.assign(context, view.rects, "test");
    radius.assign(context, view.radius, "test");
    slot_begin.assign(context, to_indices(lists.slot_begin), "test");
    tile_begin.assign(context, to_indices(lists.tile_begin), "test");
    gaussians.assign(context, to_vector(lists.gaussians), "test");
    rank.assign(context, lists.rank, "test");
  }

  void upload_record(DeviceContext& context) {
    std::vector<uint8_t> pairs(lists.instances());  // two strips of the CPU engine are one of the device
    for (size_t i = 0; i < pairs.size(); ++i) {
      for (unsigned k = 0; k < 16; ++k) pairs[i] |= static_cast<uint8_t>(((record.strips[i] >> k) & 1u) << (k / 2));
    }
    strips.assign(context, pairs, "test");
    seen.assign(context, to_vector(record.seen), "test");
    last.assign(context, to_indices(record.last), "test");
    std::vector<float> left(view.tiles() * kTilePixels);
    cpu::TileWeights weights;
    for (size_t tile = 0; tile < view.tiles(); ++tile) {
      cpu::recompute_tile_weights(view, lists, static_cast<int>(tile) % view.tiles_x,
                                  static_cast<int>(tile) / view.tiles_x, raster, record, weights);
      for (size_t i = 0; i < kTilePixels; ++i) {
        left[tile * kTilePixels + i] = weights.blocks[i / kBlockPixels].transmittance[i % kBlockPixels];
      }
    }
    transmittance.assign(context, left, "test");
  }

  DeviceArray<Splat> splats;
  DeviceArray<TileRect> rects;
  DeviceArray<float> radius, transmittance;
  DeviceArray<uint32_t> slot_begin, tile_begin, gaussians, rank, last;
  DeviceArray<uint8_t> strips, seen;
};

}  // namespace aligngs::cuda
