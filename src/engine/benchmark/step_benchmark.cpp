#include "engine/benchmark/step_benchmark.h"

#include <algorithm>
#include <ctime>
#include <memory>
#include <thread>

#include "core/error.h"
#include "core/memory_budget.h"
#include "core/steady_seconds.h"
#include "engine/cpu/cpu_engine.h"

namespace aligngs {
namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

/// One call as training makes it: the statistics of the steps so far, a tenth of the rows grows.
void time_density_control(Engine& engine, StepTiming& out) {
  Random random(1);
  const double start = steady_seconds();
  GaussianModel model;
  engine.store_shapes(model);
  const DensityStatistics statistics = engine.density_statistics();
  std::vector<float> mean;
  for (size_t i = 0; i < statistics.visible.size(); ++i) {
    if (statistics.visible[i] > 0) mean.push_back(statistics.gradient[i] / statistics.visible[i]);
  }
  DensityRule rule;
  rule.gradient_abs_threshold = 8e-4f;
  rule.prune_opacity = 0.005f;
  if (!mean.empty()) {
    const auto ninth = mean.begin() + static_cast<std::ptrdiff_t>(mean.size() * 9 / 10);
    std::nth_element(mean.begin(), ninth, mean.end());
    rule.gradient_threshold = *ninth;
  }
  engine.restructure(plan_density_control(model, statistics, rule, random));
  engine.reset_density_statistics();
  out.densify_seconds = steady_seconds() - start;
  out.densified = engine.size();
}

std::unique_ptr<Engine> engine_for(const StepBenchmarkOptions& options) {
  if (options.make_engine) return options.make_engine(options.threads);
  auto engine = std::make_unique<cpu::CpuEngine>(options.threads);
  if (!options.matrix_tiles) engine->set_semantic_products(cpu::SemanticProducts::kFloat32);
  return engine;
}

}  // namespace

const std::vector<std::string>& stage_names() {
  static const std::vector<std::string> names = {"project", "bin",      "forward",   "semantic_rows",
                                                 "losses",  "backward", "semantics", "parameter_gradients",
                                                 "optimise"};
  return names;
}

StepTiming time_steps(const StepBenchmarkOptions& options) {
  if (options.steps < 1 || options.warm_up < 0) throw_usage("a benchmark needs at least one step that counts");
  StepTiming out;
  const std::unique_ptr<Engine> engine = engine_for(options);
  out.threads =
      options.threads > 0 ? options.threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const StepRequest base = benchmark_request();
  Camera camera;
  {
    const GaussianModel model = benchmark_model(options.room);
    engine->load(model);
    std::vector<TrainingView> views;
    for (int i = 0; i < kBenchmarkViews; ++i) views.push_back(benchmark_view(options.room, i));
    camera = views[0].data.camera;
    ThreadPool pool(options.threads);
    out.tiles = cpu::tile_statistics(model, camera, base.raster, pool);
    engine->set_training_views(std::move(views));
  }
  StepRequest request = base;
  request.losses.semantic_blend = options.blend;
  out.pixel_share = options.pixel_share;
  out.blend = options.blend;
  std::vector<double> totals, processor;
  double touched = 0;
  for (int i = 0; i < options.warm_up + options.steps; ++i) {
    request.view = i % kBenchmarkViews;
    request.step = i + 1;
    request.losses.semantic_sample =
        make_semantic_sample(options.pixel_share, i / kBenchmarkViews, std::max(camera.width, camera.height));
    const std::clock_t cpu_start = std::clock();
    const double start = steady_seconds();
    const StepReport report = engine->step(request);
    const double seconds = steady_seconds() - start;
    if (report.non_finite.found) {
      throw Error({ErrorKind::kFailed,
                   "a step of the benchmark gave a value that is not finite",
                   {},
                   report.non_finite.term,
                   ""});
    }
    if (i < options.warm_up) continue;
    totals.push_back(seconds);
    processor.push_back(static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC / out.threads);
    out.samples.push_back(report.seconds);
    touched += static_cast<double>(report.visible);
  }
  out.peak_memory_bytes = peak_memory_bytes();
  out.seconds = median(totals);
  out.cpu_seconds = median(processor);
  out.best_seconds = *std::min_element(totals.begin(), totals.end());
  out.touched = static_cast<size_t>(touched / options.steps);
  for (const std::string& stage : stage_names()) {
    std::vector<double> values;
    for (const auto& sample : out.samples) {
      if (sample.count(stage) > 0) values.push_back(sample.at(stage));
    }
    if (2 * values.size() <= out.samples.size()) continue;  // what is done now and then is no part of a step
    out.stages[stage] = median(values);
    out.best_stages[stage] = *std::min_element(values.begin(), values.end());
  }
  RenderOptions render;
  render.labels = options.room.channels > 0;
  render.semantic_blend = options.blend;
  engine->render(camera, render);
  const double start = steady_seconds();
  engine->render(camera, render);
  out.render_seconds = steady_seconds() - start;
  time_density_control(*engine, out);
  return out;
}

}  // namespace aligngs
