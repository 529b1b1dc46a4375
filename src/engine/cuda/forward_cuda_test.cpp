// Projection, binning and blending against the scalar reference in double precision, and lists against the CPU engine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "device/constants.h"
#include "device/testing/device.h"
#include "device/tolerances.h"
#include "engine/cpu/binning.h"
#include "engine/cpu/project.h"
#include "engine/cuda/blend_forward.h"
#include "engine/cuda/device_frame.h"
#include "engine/cuda/model_arrays.h"
#include "engine/cuda/parameter_gradients.h"
#include "engine/cuda/project.h"
#include "engine/testing/scenes.h"

namespace aligngs::cuda {
namespace {

using namespace cpu::testing_scene;
using cpu::testing_scene::RandomSceneOptions;

class CudaForward : public DeviceTest {
 protected:
  /// The frame stays valid until the next call.
  DeviceFrame run(const GaussianModel& model, const Camera& camera, const RasterSettings& raster, size_t pairs) {
    arena_ = std::make_unique<DeviceArena>(context());
    model_.upload(context(), model, "model");
    DeviceFrame f = take_frame(*arena_, camera, raster, model.size(), true);
    take_lists(*arena_, pairs, true, f);
    project_view(context(), {model_.spans(), raster, model.sh_degree}, f.view, f.bad);
    build_tile_lists(*arena_, f.view, f.lists, f.counts, f.bad);
    blend_forward(context(), {f.view, f.lists, raster, true}, f.maps, f.record);
    return f;
  }
  template <class T>
  std::vector<std::remove_const_t<T>> host(DeviceSpan<T> span) {
    std::vector<std::remove_const_t<T>> out(span.size);
    download(context(), out.data(), span);
    return out;
  }

  void compare(const GaussianModel& model, const Camera& camera, const RasterSettings& raster) {
    const DeviceFrame f = run(model, camera, raster, 20000);
    ASSERT_EQ(host(f.bad)[0], kNoBadGradient);
    const auto splats = reference::make_splats(to_double(model), camera, raster, model.sh_degree);
    const RenderMaps<double> want = reference::render_maps(splats, raster);
    const CudaTolerance tolerance;
    const auto expect_close = [&](const std::vector<float>& got, const std::vector<double>& expected, double limit,
                                  const char* what) {
      const Difference d = difference(got, expected);
      EXPECT_LE(d.worst, limit) << what << " at " << d.at;
    };
    expect_close(host(f.maps.color), want.color, tolerance.map, "colour");
    expect_close(host(f.maps.alpha), want.alpha, tolerance.map, "alpha");
    expect_close(host(f.maps.normal), want.normal, tolerance.map, "normal");
    expect_close(host(f.maps.distance), want.distance, tolerance.map, "distance");
    expect_close(host(f.maps.expected), want.expected, tolerance.expected_depth, "expected depth");
    // A transmittance close to a half may cross it one Gaussian earlier or later.
    const std::vector<float> median = host(f.maps.median);
    size_t differing = 0;
    for (size_t u = 0; u < median.size(); ++u) {
      differing += std::abs(static_cast<double>(median[u]) - want.median[u]) > tolerance.depth * (1 + want.median[u]);
    }
    EXPECT_LE(static_cast<double>(differing), tolerance.large_flips * static_cast<double>(median.size()))
        << "median depth";
    check_record(f);
  }

  /// `seen` and `last` must agree with the bits of the strips.
  void check_record(const DeviceFrame& f) {
    const auto strips = host(f.record.strips);
    const auto seen = host(f.record.seen);
    const auto last = host(f.record.last);
    const auto begin = host(f.lists.tile_begin);
    const auto gaussians = host(f.lists.gaussians);
    const auto splats = host(f.view.splats);
    for (size_t tile = 0; tile + 1 < begin.size(); ++tile) {
      uint32_t furthest = 0;
      for (uint32_t at = begin[tile]; at < begin[tile + 1]; ++at) {
        const int x = static_cast<int>(tile) % f.view.tiles_x, y = static_cast<int>(tile) / f.view.tiles_x;
        EXPECT_EQ(seen[static_cast<size_t>(splats[gaussians[at]].slot(x, y))], strips[at] != 0);
        if (strips[at] != 0) furthest = at - begin[tile] + 1;
      }
      uint32_t largest = 0;
      for (size_t i = 0; i < kTilePixels; ++i) largest = std::max(largest, last[tile * kTilePixels + i]);
      EXPECT_EQ(largest, furthest);
    }
  }

  std::unique_ptr<DeviceArena> arena_;
  ModelArrays model_;
};

RasterSettings with_background() { return make_request().raster; }

TEST_F(CudaForward, ListsAreThoseOfTheCpuEngine) {
  RandomSceneOptions o;
  o.gaussians = 200;
  const GaussianModel model = make_model(o);
  const Camera camera = make_camera(o.width, o.height);
  ThreadPool pool(1);
  cpu::ProjectedView view;
  cpu::TileLists lists;
  cpu::project_view(model, camera, {}, model.sh_degree, pool, view);
  cpu::build_tile_lists(view, pool, lists);
  const DeviceFrame f = run(model, camera, {}, 4000);
  const auto slot_begin = host(f.lists.slot_begin);
  const auto tile_begin = host(f.lists.tile_begin);
  auto gaussians = host(f.lists.gaussians);
  gaussians.resize(lists.instances());
  EXPECT_TRUE(std::equal(slot_begin.begin(), slot_begin.end(), lists.slot_begin.begin(), lists.slot_begin.end()));
  EXPECT_TRUE(std::equal(tile_begin.begin(), tile_begin.end(), lists.tile_begin.begin(), lists.tile_begin.end()));
  EXPECT_TRUE(std::equal(gaussians.begin(), gaussians.end(), lists.gaussians.data()));
  EXPECT_EQ(host(f.lists.rank), lists.rank);
  EXPECT_EQ(host(f.counts)[0].instances, lists.instances());
  EXPECT_EQ(host(f.counts)[0].unculled, lists.visible.size());
}

TEST_F(CudaForward, MapsOfARandomScene) {
  const RandomSceneOptions o;
  compare(make_model(o), make_camera(o.width, o.height), with_background());
}

TEST_F(CudaForward, DoesNotDependOnTheOrderOfThreads) {
  RandomSceneOptions o;
  o.gaussians = 120;
  const GaussianModel model = make_model(o);
  const Camera camera = make_camera(o.width, o.height);
  const auto maps = [&] {
    const DeviceFrame f = run(model, camera, with_background(), 4000);
    return std::make_pair(host(f.maps.color), host(f.maps.expected));
  };
  const auto first = maps();
  for_each_thread_order([&] { EXPECT_EQ(maps(), first); });
}

TEST_F(CudaForward, NoGaussian) {
  RandomSceneOptions o;
  o.gaussians = 0;
  compare(make_model(o), make_camera(o.width, o.height), with_background());
}

TEST_F(CudaForward, OneGaussian) {
  RandomSceneOptions o;
  o.gaussians = 1;
  compare(make_model(o), make_camera(o.width, o.height), with_background());
}

TEST_F(CudaForward, NothingInSight) {
  RandomSceneOptions o;
  o.gaussians = 20;
  o.depth_min = -4;
  o.depth_max = -1;
  compare(make_model(o), make_camera(o.width, o.height), with_background());
}

TEST_F(CudaForward, ManyInATile) {
  RandomSceneOptions o;
  o.width = o.height = 16;
  o.gaussians = 1200;  // several batches, and pixels that close
  o.log_scale_max = -0.5;
  compare(make_model(o), make_camera(o.width, o.height), with_background());
}

TEST_F(CudaForward, WideRectangles) {
  RandomSceneOptions o;
  o.width = 130;
  o.height = 100;
  o.gaussians = 20;
  o.log_scale_min = o.log_scale_max = 0;
  GaussianModel model = make_model(o);
  const DeviceFrame f = run(model, make_camera(o.width, o.height), {}, 4000);
  EXPECT_GT(host(f.counts)[0].instances, 20u * kWideRectangle);
  compare(model, make_camera(o.width, o.height), with_background());
}

TEST_F(CudaForward, OpacitiesAtTheThreshold) {
  RandomSceneOptions o;
  o.logit_min = -5.6;
  o.logit_max = -5.3;  // around 1 / 255
  compare(make_model(o), make_camera(o.width, o.height), with_background());
}

TEST_F(CudaForward, EqualDepthsBlendInRowOrder) {
  RandomSceneOptions o;
  o.depth_min = o.depth_max = 2;
  GaussianModel model = make_model(o);
  const Camera camera = make_camera(o.width, o.height);
  for (size_t i = 1; i < model.size(); ++i) {
    for (size_t k = 0; k < 3; ++k) model.positions[3 * i + k] = model.positions[k];
  }
  compare(model, camera, with_background());
}

TEST_F(CudaForward, RowsThatAreNotFiniteAreNamed) {
  RandomSceneOptions o;
  o.gaussians = 50;
  const Camera camera = make_camera(o.width, o.height);
  GaussianModel model = make_model(o);
  model.log_scales[3 * 31 + 1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(host(run(model, camera, {}, 4000).bad)[0], bad_gradient_key(31, GradientClass::kPositions));
  model.positions[3 * 12] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(host(run(model, camera, {}, 4000).bad)[0], bad_gradient_key(12, GradientClass::kPositions));
}

TEST_F(CudaForward, AFiniteRowWhoseImageOverflowsIsOnlyCulled) {
  RandomSceneOptions o;
  o.gaussians = 5;
  GaussianModel model = make_model(o);
  model.log_scales[3] = 80;
  const DeviceFrame f = run(model, make_camera(o.width, o.height), {}, 4000);
  EXPECT_EQ(host(f.bad)[0], kNoBadGradient);
  EXPECT_EQ(host(f.view.rects)[1].area(), 0u);
}

TEST_F(CudaForward, PairsWithoutRoomCullEverythingAndSaySo) {
  const RandomSceneOptions o;
  const GaussianModel model = make_model(o);
  const DeviceFrame f = run(model, make_camera(o.width, o.height), with_background(), 16);
  const BinCounts counts = host(f.counts)[0];
  EXPECT_EQ(counts.overflow, 1u);
  EXPECT_GT(counts.instances, 16u);
  EXPECT_EQ(host(f.bad)[0], 0u);
  for (const float a : host(f.maps.alpha)) EXPECT_EQ(a, 0.0f);
  EXPECT_EQ(host(f.lists.slot_begin).back(), 0u);
}

TEST_F(CudaForward, ExactlyEnoughRoomIsEnough) {
  const RandomSceneOptions o;
  const GaussianModel model = make_model(o);
  const Camera camera = make_camera(o.width, o.height);
  const size_t needed = host(run(model, camera, {}, 8000).counts)[0].instances;
  const DeviceFrame f = run(model, camera, {}, needed);
  EXPECT_EQ(host(f.counts)[0].overflow, 0u);
  EXPECT_EQ(host(f.lists.tile_begin).back(), needed);
}

}  // namespace
}  // namespace aligngs::cuda
