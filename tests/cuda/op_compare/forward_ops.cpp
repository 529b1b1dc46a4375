#include "compare_ops.h"
#include "device/tolerances.h"
#include "engine/cuda/binning.h"
#include "engine/cuda/blend_forward.h"
#include "engine/cuda/device_frame.h"
#include "engine/cuda/project.h"

namespace aligngs::op_compare {
namespace {

using cuda::CudaTolerance;
using cuda::DeviceFrame;

constexpr size_t kRoom = 100;  ///< room for pairs that the lists do not need: it must stay behind every tile

void compare_project(cuda::DeviceContext& context, const CpuStep& step, OpTable& table) {
  const CompareScene& scene = step.scene;
  cuda::DeviceModel model(context, scene.model);
  cuda::DeviceArena arena(context);
  const DeviceFrame frame = take_frame(arena, scene.training.data.camera, step.view.raster, scene.model.size(), true);
  project_view(context, {model.spans(), step.view.raster, scene.request.sh_degree}, frame.view, frame.bad);
  const auto splats = to_host(context, frame.view.splats);
  const auto rects = to_host(context, frame.view.rects);
  const auto radius = to_host(context, frame.view.radius);
  const auto& want = step.view.view;
  const CudaTolerance t;

  std::vector<uint16_t> got_rects, want_rects;
  for (size_t i = 0; i < want.size(); ++i) {
    for (const uint16_t x : {rects[i].x0, rects[i].y0, rects[i].x1, rects[i].y1}) got_rects.push_back(x);
    for (const uint16_t x : {want.rects[i].x0, want.rects[i].y0, want.rects[i].x1, want.rects[i].y1}) {
      want_rects.push_back(x);
    }
  }
  table.compare("project", "rectangles", got_rects, want_rects, exact(t.flips));
  const auto in_view = [&](size_t i) { return rects[i].area() > 0 && want.rects[i].area() > 0; };
  const struct {
    const char* name;
    size_t first, count;
  } fields[] = {{"mean", 0, 2},   {"conic factor", 2, 3}, {"opacity", 5, 1},   {"level", 6, 1},
                {"colour", 7, 3}, {"normal", 10, 3},      {"distance", 13, 1}, {"depths", 14, 3}};
  static_assert(offsetof(Splat, level) == 24 && offsetof(Splat, normal) == 40 && offsetof(Splat, z) == 56);
  for (const auto& f : fields) {
    table.compare("project", f.name, fields_of(splats, splats.size(), f.first, f.count, in_view),
                  fields_of(want.splats, want.size(), f.first, f.count, in_view), tight(t.projection));
  }
  table.compare("project", "radius", fields_of(radius, radius.size(), 0, 1, in_view),
                fields_of(want.radius, want.size(), 0, 1, in_view), tight(t.projection));
}

/// A frame with the CPU's splats and rectangles.
DeviceFrame projected_frame(cuda::DeviceArena& arena, const CpuStep& step) {
  const CompareScene& scene = step.scene;
  DeviceFrame frame = take_frame(arena, scene.training.data.camera, step.view.raster, scene.model.size(), true);
  const cuda::ViewSpans from = step.view.view_spans();
  frame.view.camera = from.camera;
  copy(arena.context(), frame.view.splats, from.splats);
  copy(arena.context(), frame.view.rects, from.rects);
  copy(arena.context(), frame.view.radius, from.radius);
  return frame;
}

void compare_lists(cuda::DeviceContext& context, const CpuStep& step, OpTable& table) {
  cuda::DeviceArena arena(context);
  DeviceFrame frame = projected_frame(arena, step);
  const cpu::TileLists& want = step.view.lists;
  take_lists(arena, want.instances() + kRoom, true, frame);
  build_tile_lists(arena, frame.view, frame.lists, frame.counts, frame.bad);
  auto gaussians = to_host(context, frame.lists.gaussians);
  gaussians.resize(want.instances());
  table.compare("lists", "slots", to_host(context, frame.lists.slot_begin), want.slot_begin, exact());
  table.compare("lists", "tiles", to_host(context, frame.lists.tile_begin), want.tile_begin, exact());
  table.compare("lists", "gaussians", gaussians, want.gaussians, exact());
  table.compare("lists", "ranks", to_host(context, frame.lists.rank), want.rank, exact());
  const cuda::BinCounts counts = to_host(context, frame.counts)[0];
  table.compare_number("lists", "pairs", static_cast<double>(counts.instances), static_cast<double>(want.instances()),
                       exact());
  table.compare_number("lists", "unculled", counts.unculled, static_cast<double>(want.visible.size()), exact());
}

void compare_blend(cuda::DeviceContext& context, const CpuStep& step, OpTable& table) {
  cuda::TestView& view = step.view;
  cuda::DeviceArena arena(context);
  DeviceFrame frame = projected_frame(arena, step);
  take_lists(arena, step.view.lists.instances(), true, frame);
  blend_forward(context, {frame.view, view.list_spans(), step.view.raster, true}, frame.maps, frame.record);
  const RenderMaps<float>& want = step.view.maps;
  const CudaTolerance t;
  table.compare("blend_forward", "colour", to_host(context, frame.maps.color), want.color, tight(t.map));
  table.compare("blend_forward", "alpha", to_host(context, frame.maps.alpha), want.alpha, tight(t.map));
  table.compare("blend_forward", "normal", to_host(context, frame.maps.normal), want.normal, tight(t.map));
  table.compare("blend_forward", "distance", to_host(context, frame.maps.distance), want.distance, tight(t.map));
  table.compare("blend_forward", "expected depth", to_host(context, frame.maps.expected), want.expected,
                tight(t.expected_depth));
  table.compare("blend_forward", "median depth", to_host(context, frame.maps.median), want.median,
                with_large_flips(tight(t.depth)));
  const cuda::BlendRecordSpans record = view.record_spans();
  table.compare("blend_forward", "strips", to_host(context, frame.record.strips), to_host(context, record.strips),
                exact(t.flips));
  table.compare("blend_forward", "seen", to_host(context, frame.record.seen), to_host(context, record.seen),
                exact(t.flips));
  table.compare("blend_forward", "last taken", to_host(context, frame.record.last), to_host(context, record.last),
                exact(t.flips));
  table.compare("blend_forward", "transmittance", to_host(context, frame.record.transmittance),
                to_host(context, record.transmittance), tight(t.map));
}

}  // namespace

void compare_forward(cuda::DeviceContext& context, const CpuStep& step, OpTable& table) {
  compare_project(context, step, table);
  compare_lists(context, step, table);
  compare_blend(context, step, table);
}

}  // namespace aligngs::op_compare
