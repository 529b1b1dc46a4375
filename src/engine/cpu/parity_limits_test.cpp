// The engine against the scalar reference where blending is at its limits. The limits are one Gaussian, ten thousand in
// a tile, alphas and transmittances near their thresholds. One case is a window of a scene with the tile statistics of
// a real room.
#include "engine/benchmark/benchmark_room.h"
#include "engine/cpu/project.h"
#include "engine/cpu/testing/parity.h"
#include "engine/cpu/testing/threshold_scenes.h"
#include "engine/cpu/tile_statistics.h"
#include "engine/prepare_view.h"
#include "gaussians/restructure.h"
#include "scene/semantic_target.h"

namespace aligngs::cpu {
namespace {

using namespace testing_scene;

class CpuParityAtLimits : public ParityTest {};
INSTANTIATE_TEST_SUITE_P(Products, CpuParityAtLimits, every_products(), products_name);

/// 64 x 48 pixels of the benchmark's room at 320 x 240, and the Gaussians that reach them.
struct RoomWindow {
  GaussianModel model;
  TrainingView view;
};
template <class T>
Image<T> window_of(const Image<T>& image, int left, int top, int width, int height) {
  Image<T> out(width, height, image.channels);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < image.channels; ++c) out.at(x, y, c) = image.at(left + x, top + y, c);
    }
  }
  return out;
}
RoomWindow make_room_window() {
  constexpr int kLeft = 96, kTop = 112, kWidth = 64, kHeight = 48;  // whole tiles of the image
  const BenchmarkRoom room{320, 240, 50000, 150};
  const ViewData whole = benchmark_view(room, 1).data;
  ViewData data;
  data.name = "window";
  data.camera = whole.camera;
  data.camera.width = kWidth;
  data.camera.height = kHeight;
  data.camera.cx -= kLeft;
  data.camera.cy -= kTop;
  data.color = window_of(whole.color, kLeft, kTop, kWidth, kHeight);
  data.prior_depth = window_of(whole.prior_depth, kLeft, kTop, kWidth, kHeight);
  data.labels = window_of(whole.labels, kLeft, kTop, kWidth, kHeight);
  const SemanticTarget& teacher = whole.semantics;  // of half the size
  SemanticTarget& t = data.semantics;
  t.channels = teacher.channels;
  t.width = kWidth / 2;
  t.height = kHeight / 2;
  for (int y = 0; y < t.height; ++y) {
    const size_t first = static_cast<size_t>((kTop / 2 + y) * teacher.width + kLeft / 2), c = room.channels;
    const auto row = teacher.probabilities.begin() + static_cast<std::ptrdiff_t>(first * c);
    t.probabilities.insert(t.probabilities.end(), row, row + static_cast<std::ptrdiff_t>(t.width * c));
    const auto confidence = teacher.confidence.begin() + static_cast<std::ptrdiff_t>(first);
    t.confidence.insert(t.confidence.end(), confidence, confidence + t.width);
  }
  normalise_target(t);
  RoomWindow window;
  window.model = benchmark_model(room);
  ThreadPool pool(1);
  ProjectedView seen;
  project_view(window.model, data.camera, RasterSettings(), 0, pool, seen);
  std::vector<uint8_t> keep;
  for (const TileRect& rect : seen.rects) keep.push_back(rect.area() > 0 ? 1 : 0);
  restructure_model(plan_keep(keep), window.model);
  window.model = away_from_thresholds(window.model, data.camera, RasterSettings());
  window.view = prepare_view(std::move(data));
  return window;
}

TEST_P(CpuParityAtLimits, NoGaussians) {
  RandomSceneOptions o;
  o.gaussians = 0;
  compare_step(make_model(o), make_view(o), make_geometry_request());
}

TEST_P(CpuParityAtLimits, ExactlyOneGaussian) {
  RandomSceneOptions o;
  o.width = o.height = 20;  // four tiles, the Gaussian over all of them
  GaussianModel model = with_dots({{16, 15, 2.0, 0.8}}, o, GaussianModel());
  ASSERT_EQ(model.size(), 1u);
  for (const float size : {-1.0f, -3.0f}) {
    SCOPED_TRACE(size);
    Tolerance t;
    t.bfloat16_rows = 8e-3;                               // a product of one term: its roundings do not cancel
    model.log_scales = {size, size - 0.5f, size - 1.0f};  // not alike: a ball would not feel its rotation
    compare_step(model, make_view(o), make_geometry_request(), t);
    StepRequest r = make_request();
    r.losses.semantic_blend = SemanticBlend::kLogits;
    compare_step(model, make_view(o), r, t);
  }
}

/// So faint that no pixel closes: every pixel goes through all batches of 256 that the forward pass gathers.
TEST_P(CpuParityAtLimits, TenThousandFaintGaussiansInOneTile) {
  RandomSceneOptions o;
  o.width = o.height = 16;
  o.gaussians = 10000;
  o.channels = 31;
  o.log_scale_min = -3;
  o.log_scale_max = -0.8;
  o.logit_min = -5.4;  // opacity from 1.15 / 255
  o.logit_max = -4.0;
  const StepRequest r = make_geometry_request();
  const Camera camera = make_camera(o.width, o.height);
  const GaussianModel model = away_from_thresholds(make_model(o), camera, r.raster);
  ThreadPool pool(1);
  const TileStatistics statistics = tile_statistics(model, camera, r.raster, pool);
  EXPECT_GT(statistics.used, 20u * 256u);
  CpuEngine engine(1);
  engine.load(model);
  for (const float alpha : engine.render(camera, {r.raster}).alpha.data) {
    EXPECT_GT(alpha, 0.5f);                                // enough for the coupling
    EXPECT_LT(alpha, 1 - 2 * r.raster.transmittance_min);  // and open to the end
  }
  compare_step(model, make_view(o), r);
  StepRequest plain = make_request();
  plain.losses.semantic_blend = SemanticBlend::kLogits;
  compare_step(model, make_view(o), plain);
}

/// Dots before a room, each above or below the threshold by the least that float can express. One too many or too few
/// moves its pixel's colour by some 1e-3.
TEST_P(CpuParityAtLimits, AlphaAtItsThreshold) {
  const RandomSceneOptions o;
  const StepRequest r = make_geometry_request();
  const double threshold = static_cast<double>(r.raster.alpha_min);
  std::vector<Dot> dots;
  for (int y = 2; y < o.height; y += 5) {
    for (int x = 2; x < o.width; x += 5) {
      const int turn = static_cast<int>(dots.size());
      const double beside = (turn % 2 == 0 ? 1 : -1) * std::pow(10.0, -2 - turn / 2 % 4);  // 1e-2 to 1e-5
      dots.push_back({x, y, 0.3 + 1e-3 * turn, threshold * (1 + beside)});
    }
  }
  const Camera camera = make_camera(o.width, o.height);
  const GaussianModel model = with_dots(dots, o, away_from_thresholds(make_model(o), camera, r.raster));
  CpuEngine engine(1);
  engine.load(model);
  engine.set_training_views({make_view(o)});
  engine.step(r);
  const std::vector<float> visible = engine.density_statistics().visible;
  for (size_t i = 0; i < dots.size(); ++i) {
    EXPECT_EQ(visible[i], dots[i].opacity > threshold ? 1.0f : 0.0f) << i << ": " << dots[i].opacity / threshold - 1;
  }
  compare_step(model, make_view(o), r);
}

/// Stacks of dots whose fourth would leave just more or just less than transmittance_min. It is the last one taken, or
/// the first one not taken. The fainter fifth behind it is never taken, though there would be room for it.
TEST_P(CpuParityAtLimits, TransmittanceAtItsThreshold) {
  const RandomSceneOptions o;
  const StepRequest r = make_geometry_request();
  std::vector<Dot> dots;
  const double solid = opacity_of(logit_of(0.9)), three = std::pow(1 - solid, 3);
  const double least = static_cast<double>(r.raster.transmittance_min);
  for (int y = 3; y < o.height; y += 6) {
    for (int x = 3; x < o.width; x += 6) {
      const int turn = static_cast<int>(dots.size()) / 5;
      const double beside = (turn % 2 == 0 ? 1 : -1) * std::pow(10.0, -2 - turn / 2 % 3);  // 1e-2 to 1e-4
      const double fourth = 1 - least * (1 + beside) / three;
      for (const double opacity : {solid, solid, solid, fourth, 0.3}) {
        dots.push_back({x, y, 0.3 + 1e-3 * static_cast<double>(dots.size()), opacity});
      }
    }
  }
  const Camera camera = make_camera(o.width, o.height);
  const GaussianModel model = with_dots(dots, o, away_from_thresholds(make_model(o), camera, r.raster));
  CpuEngine engine(1);
  engine.load(model);
  const ImageF alpha = engine.render(camera, {r.raster}).alpha;
  for (size_t i = 0; i < dots.size(); i += 5) {
    const double left = 1 - static_cast<double>(alpha.at(dots[i].x, dots[i].y));
    EXPECT_NEAR(left, three * (1 - dots[i + 3].opacity) >= least ? least : three, 0.02 * three) << i;
  }
  compare_step(model, make_view(o), r);
}

/// A window of the benchmark's room, which has the tile statistics of a real one, with every loss that a preset has.
TEST_P(CpuParityAtLimits, WindowOfTheBenchmarkRoom) {
  const RoomWindow window = make_room_window();
  ThreadPool pool(1);
  const StepRequest r = benchmark_request();
  const TileStatistics t = tile_statistics(window.model, window.view.data.camera, r.raster, pool);
  EXPECT_NEAR(static_cast<double>(t.pairs) / static_cast<double>(t.tiles), 415, 200);
  EXPECT_NEAR(static_cast<double>(t.active) / static_cast<double>(t.pixels), 54, 20);
  {
    SCOPED_TRACE("default");
    compare_step(window.model, window.view, r);
  }
  SCOPED_TRACE("paper");
  StepRequest paper = r;
  paper.losses.semantic_blend = SemanticBlend::kLogits;
  paper.losses.coupling = SemanticCoupling::kPlain;
  paper.losses.coupling_strength = 1;
  compare_step(window.model, window.view, paper, of_coupling_alone());
}

}  // namespace
}  // namespace aligngs::cpu
