// Sums per (Gaussian, tile) against those of the CPU engine, from the same splats, lists and record.
#include "engine/cuda/blend_backward.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/random.h"
#include "device/tolerances.h"
#include "engine/cuda/blend_forward.h"
#include "engine/cuda/testing/view.h"
#ifdef ALIGNGS_CUDA_EMULATED
#include "device/emulation/emulation.h"
#endif

namespace aligngs::cuda {
namespace {

using cpu::testing_scene::difference;
using cpu::testing_scene::make_camera;
using cpu::testing_scene::make_model;
using cpu::testing_scene::RandomSceneOptions;

struct Options {
  RandomSceneOptions scene;
  bool geometry = true, density = true, prior = true;
  bool smooth = false;
};

/// Every test for both methods.
class CudaBlendBackward : public DeviceTest, public testing::WithParamInterface<BlendBackwardMethod> {
 protected:
  void prepare(const Options& o) {
    options = o;
    RasterSettings raster;
    raster.background[0] = 0.3f;
    raster.background[2] = 0.7f;
    raster.smooth_cutoff = o.smooth;
    model = make_model(o.scene);
    view = std::make_unique<TestView>(context(), model, make_camera(o.scene.width, o.scene.height), raster);
    Random random(3);
    const auto fill = [&](std::vector<float>& v, size_t n, double low, double high) {
      v.resize(n);
      for (float& x : v) x = static_cast<float>(random.uniform(low, high));
    };
    const size_t n = view->maps.pixels();
    fill(gradients.color, 3 * n, -1, 1);
    fill(gradients.normal, 3 * n, -1, 1);
    fill(gradients.distance, n, -1, 1);
    fill(gradients.alpha, n, -1, 1);
    fill(residual, n, 0, 1);
    fill(prior, n, -0.5, 4);  // an eighth has none
  }

  std::vector<SplatGradient> run_device() {
    DeviceArray<float> color, normal, distance, alpha, residual_map, prior_map;
    color.assign(context(), gradients.color, "test");
    normal.assign(context(), gradients.normal, "test");
    distance.assign(context(), gradients.distance, "test");
    alpha.assign(context(), gradients.alpha, "test");
    residual_map.assign(context(), residual, "test");
    prior_map.assign(context(), prior, "test");
    DeviceArray<SplatGradient> slots(context(), view->lists.instances(), "test");
    BlendBackwardInputs in;
    in.view = view->view_spans();
    in.lists = view->list_spans();
    in.record = view->record_spans();
    in.gradients = {color.span(), normal.span(), distance.span(), alpha.span()};
    in.residual = residual_map.span();
    if (options.prior) in.prior = prior_map.span();
    in.prior_scale = 1.1f;
    in.raster = view->raster;
    in.geometry = options.geometry;
    in.density = options.density;
    in.method = GetParam();
    if (in.method == BlendBackwardMethod::kPerSplat) {
      remember_forward(in);
      in.maps = device_maps.spans(view->view);
    }
    blend_backward(context(), in, slots.span());
    return slots.to_host();
  }

  /// Maps and checkpoints, which the CPU engine does not have, by the device's forward pass; the rest of its record
  /// goes.
  void remember_forward(BlendBackwardInputs& in) {
    const size_t pairs = view->lists.instances(), tiles = view->view.tiles();
    const size_t count = checkpoint_count(pairs) * kTilePixels;
    checkpoints.resize(context(), count, "test");
    plane_checkpoints.resize(context(), count, "test");
    DeviceArray<uint8_t> strips(context(), pairs, "test"), seen(context(), pairs, "test");
    DeviceArray<uint32_t> last(context(), tiles * kTilePixels, "test");
    DeviceArray<float> left(context(), tiles * kTilePixels, "test");
    device_maps.resize(context(), view->maps.pixels());
    blend_forward(context(), {in.view, in.lists, in.raster, true}, device_maps.spans(view->view),
                  {strips.span(), seen.span(), last.span(), left.span(), checkpoints.span(), plane_checkpoints.span()});
    in.record.checkpoints = checkpoints.span();
    in.record.plane_checkpoints = plane_checkpoints.span();
  }

  cpu::SlotGradients run_cpu() {
    cpu::SlotGradients slots;
    cpu::RowBatches batches;
    cpu::backward_pass({view->view, view->lists, view->raster}, view->record,
                       {gradients, residual.data(), options.prior ? prior.data() : nullptr, 1.1f}, options.geometry,
                       options.density, nullptr, view->pool, view->scratch, batches, slots);
    return slots;
  }

  /// Every field of every seen slot, scaled by the field's largest magnitude.
  void expect_equal() {
    const std::vector<SplatGradient> got = run_device();
    const cpu::SlotGradients want = run_cpu();
    const bool density = options.density || options.smooth;  // the smooth version of the CPU engine computes everything
    ASSERT_EQ(density, options.density);
    for (int field = 0; field < kSplatGradientFloats; ++field) {
      const bool in_density = field == kSumResidual || field == kSumUnsupported || field >= kSumPhotometricAbsP;
      const bool in_geometry = field >= kSumNormal && field <= kSumDistance;
      std::vector<float> a, b;
      for (size_t slot = 0; slot < got.size(); ++slot) {
        if (view->record.seen[slot] == 0) continue;
        a.push_back(reinterpret_cast<const float*>(&got[slot])[field]);
        b.push_back(reinterpret_cast<const float*>(&want[slot])[field]);
      }
      const auto d = difference(a, b);
      EXPECT_LE(d.worst, CudaTolerance().slot_sum)
          << "field " << field << " of entry " << d.at << ", largest " << d.scale;
      if ((in_density && !options.density) || (in_geometry && !options.geometry)) {
        for (const float x : a) ASSERT_EQ(x, 0.0f) << "field " << field;
      }
    }
  }

  Options options;
  GaussianModel model;
  std::unique_ptr<TestView> view;
  MapGradients<float> gradients;
  std::vector<float> residual, prior;

  struct Maps {
    void resize(DeviceContext& context, size_t n) {
      for (auto* map : {&color, &normal}) map->resize(context, 3 * n, "test");
      for (auto* map : {&alpha, &distance, &expected, &median}) map->resize(context, n, "test");
    }
    RenderMapSpans spans(const cpu::ProjectedView& v) {
      return {v.width,      v.height,        color.span(),    normal.span(),
              alpha.span(), distance.span(), expected.span(), median.span()};
    }
    DeviceArray<float> color, normal, alpha, distance, expected, median;
  };
  Maps device_maps;
  DeviceArray<BlendCheckpoint> checkpoints;
  DeviceArray<PlaneCheckpoint> plane_checkpoints;
};

INSTANTIATE_TEST_SUITE_P(BothMethods, CudaBlendBackward,
                         testing::Values(BlendBackwardMethod::kPerPixel, BlendBackwardMethod::kPerSplat),
                         [](const auto& method) {
                           return method.param == BlendBackwardMethod::kPerPixel ? "PerPixel" : "PerSplat";
                         });

TEST_P(CudaBlendBackward, SumsOfEveryKindEqualThoseOfTheCpuEngine) {
  for (const bool geometry : {true, false}) {
    for (const bool density : {true, false}) {
      SCOPED_TRACE(std::to_string(geometry) + std::to_string(density));
      Options o;
      o.geometry = geometry;
      o.density = density;
      o.scene.width = 37;
      o.scene.height = 21;
      o.scene.gaussians = 80;
      prepare(o);
      expect_equal();
    }
  }
}

TEST_P(CudaBlendBackward, WithoutAPriorNoDepthIsSupported) {
  Options o;
  o.prior = false;
  o.scene.gaussians = 60;
  prepare(o);
  expect_equal();
  const std::vector<SplatGradient> slots = run_device();
  for (size_t i = 0; i < slots.size(); ++i) {
    if (view->record.seen[i] == 0) continue;
    EXPECT_FLOAT_EQ(slots[i].unsupported, slots[i].weight);
  }
}

TEST_P(CudaBlendBackward, ManyGaussiansInATileOfWhichMostAreHidden) {
  Options o;
  o.scene.width = o.scene.height = 16;
  o.scene.gaussians = 900;
  o.scene.log_scale_min = -3;
  prepare(o);
  ASSERT_GT(view->lists.instances(), 600u);
  expect_equal();
}

TEST_P(CudaBlendBackward, ManyFaintGaussiansThatAllTakePart) {
  Options o;
  o.scene.width = 21;  // the second tile ends after five columns
  o.scene.height = 16;
  o.scene.gaussians = 1000;
  o.scene.log_scale_min = -2;
  o.scene.logit_min = -5.4;  // 1/255 is at -5.54
  o.scene.logit_max = -4.5;
  prepare(o);
  const auto furthest =
      *std::max_element(view->record.last.data(), view->record.last.data() + view->record.last.size());
  ASSERT_GT(furthest, 16 * static_cast<int>(kCheckpointPlaces));  // more than the warps of one block
  expect_equal();
}

TEST_P(CudaBlendBackward, TheSmoothCutoffOfTheGradientTests) {
  Options o;
  o.smooth = true;
  o.scene.gaussians = 50;
  prepare(o);
  expect_equal();
}

TEST_P(CudaBlendBackward, OneGaussianAndNone) {
  for (const size_t gaussians : {size_t(1), size_t(0)}) {
    Options o;
    o.scene.gaussians = gaussians;
    o.scene.log_scale_min = -2;
    o.scene.seed = 4;
    prepare(o);
    ASSERT_EQ(view->visible, gaussians);
    expect_equal();
  }
}

TEST_P(CudaBlendBackward, AlphaAtTheThresholdAndAtTheClamp) {
  Options o;
  o.scene.gaussians = 60;
  prepare(o);
  // Opacities of 1/255 take part in single pixels or none; those of almost 1 are clamped to 0.99.
  for (size_t i = 0; i < model.size(); ++i) model.opacity_logits[i] = i % 2 == 0 ? -5.5373f : 12.0f;
  const RasterSettings raster = view->raster;
  view = std::make_unique<TestView>(context(), model, make_camera(o.scene.width, o.scene.height), raster);
  expect_equal();
}

#ifdef ALIGNGS_CUDA_EMULATED
TEST_P(CudaBlendBackward, NoBarrierIsMissing) {
  Options o;
  o.scene.width = o.scene.height = 24;
  o.scene.gaussians = 70;
  prepare(o);
  const std::vector<SplatGradient> want = run_device();
  for (const ThreadOrder order : {ThreadOrder::kReverse, ThreadOrder::kShuffled}) {
    const ScopedThreadOrder scope(order, 7);
    const std::vector<SplatGradient> got = run_device();
    for (size_t i = 0; i < got.size(); ++i) {
      if (view->record.seen[i] == 0) continue;
      ASSERT_EQ(0, std::memcmp(&got[i], &want[i], sizeof got[i])) << i;
    }
  }
}
#endif

}  // namespace
}  // namespace aligngs::cuda
