#include "engine/cpu/cpu_engine.h"

#include <cmath>
#include <cstring>
#include <iterator>
#include <utility>

#include "core/error.h"
#include "core/huge_pages.h"
#include "core/steady_seconds.h"
#include "engine/cpu/adam.h"
#include "engine/cpu/bf16_packing.h"
#include "engine/cpu/matrix_tiles.h"
#include "engine/cpu/pose_gradient.h"
#include "engine/cpu/project.h"
#include "engine/cpu/semantic_rows.h"
#include "engine/cpu/tile_products.h"
#include "engine/engine_arrays.h"

namespace aligngs::cpu {
namespace {

constexpr size_t kEngineRowsPerTask = 512;
/// a row of 600 bytes is rounded in about a quarter of a miss of the last cache
constexpr size_t kEngineRowsAhead = 4;

/// Writes the wall time since the last call under a name.
class Stopwatch {
 public:
  explicit Stopwatch(std::map<std::string, double>& seconds) : seconds_(seconds) {}
  void lap(const char* stage) {
    const double now = steady_seconds();
    seconds_[stage] += now - last_;
    last_ = now;
  }

 private:
  std::map<std::string, double>& seconds_;
  double last_ = steady_seconds();
};

/// MapGradients::reset on several threads: ten megabytes at 640 x 480.
void clear_gradients(size_t pixels, ThreadPool& pool, MapGradients<float>& out) {
  const std::pair<std::vector<float>*, size_t> maps[] = {
      {&out.color, 3 * pixels}, {&out.normal, 3 * pixels}, {&out.distance, pixels}, {&out.alpha, pixels}};
  pool.parallel_for(std::size(maps), 1, [&](size_t i, size_t, int) {
    std::vector<float>& map = *maps[i].first;
    const bool grows = map.capacity() < maps[i].second;
    map.assign(maps[i].second, 0.0f);
    if (grows) ask_for_huge_pages(map);
  });
}

/// First row of `values` (width numbers per row) that is not finite, or -1.
int64_t first_bad_row(const std::vector<float>& values, size_t width) {
  for (size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) return static_cast<int64_t>(i / width);
  }
  return -1;
}

}  // namespace

CpuEngine::CpuEngine(int threads) : pool_(std::make_unique<ThreadPool>(threads)) {
  scratch_.resize(static_cast<size_t>(pool_->size()));
}

void CpuEngine::set_semantic_products(SemanticProducts products) {
  if (products == SemanticProducts::kBfloat16 && !matrix_tiles_available()) {
    throw_usage("bfloat16 products need AMX, which this processor, system or build does not offer",
                "use the automatic choice");
  }
  products_ = products;
}

void CpuEngine::prepare_frame(const Camera& camera, const RasterSettings& raster, int sh_degree) const {
  project_view(model_, camera, raster, sh_degree, *pool_, frame_.view);
  build_tile_lists(frame_.view, *pool_, frame_.lists);
}

void CpuEngine::prepare_features(SemanticBlend blend, const uint8_t* touched) const {
  const size_t channels = static_cast<size_t>(model_.semantic_channels);
  const size_t padded = padded_channels(model_.semantic_channels);
  frame_.features.resize(frame_.lists.visible.size() * padded);
  pool_->parallel_for(model_.size(), kEngineRowsPerTask, [&](size_t begin, size_t end, int) {
    const auto prefetch = [&](size_t i) {
      if (i < end && touched != nullptr && touched[i] != 0) prefetch_row(&model_.semantics[i * channels], channels);
    };
    for (size_t i = begin; i < end; ++i) {
      prefetch(i + kEngineRowsAhead);
      if (touched != nullptr ? touched[i] == 0 : frame_.view.rects[i].area() == 0) continue;
      const float* in = model_.semantics.data() + i * channels;
      float* row = frame_.features.data() + size_t(frame_.lists.rank[i]) * padded;
      if (blend == SemanticBlend::kProbabilities) {
        softmax_row(in, channels, padded, counts_.last_log_count(), row);
      } else {
        copy_row(in, channels, padded, row);
      }
    }
  });
}

bool CpuEngine::prepare_rounded(SemanticBlend blend) {
  const size_t channels = static_cast<size_t>(model_.semantic_channels);
  const size_t padded = padded_channels(model_.semantic_channels), depth = padded_depth(padded);
  if (rounded_for_ == blend) return false;
  rounded_.resize(model_.size() * depth);
  pool_->parallel_for(model_.size(), kEngineRowsPerTask, [&](size_t begin, size_t end, int worker) {
    AlignedArray<float>& scratch = scratch_[static_cast<size_t>(worker)].semantic.block.student;
    scratch.resize(padded);
    for (size_t i = begin; i < end; ++i) {
      round_features(model_.semantics.data() + i * channels, channels, padded, depth,
                     blend == SemanticBlend::kProbabilities, counts_.last_log_count(), scratch.data(),
                     rounded_.data() + i * depth);
    }
  });
  rounded_for_ = blend;
  return true;
}

bool CpuEngine::semantics_active(const StepRequest& request) {
  const TrainingView& view = views_[static_cast<size_t>(request.view)];
  if (model_.semantic_channels == 0 || view.data.semantics.empty()) return false;
  if (view.data.semantics.channels != model_.semantic_channels) return false;
  if (map_.remainder() != active_.remainder()) return false;  // a model of another number of classes
  if (!request.losses.has(LossStage::kSemantics)) return false;
  SemanticView& cache = semantic_views_[static_cast<size_t>(request.view)];
  if (!cache.ready) prepare_semantic_view(view, counts_.classes(), *pool_, cache);
  return cache.valid > 0;
}

NonFinite CpuEngine::locate(NonFinite symptom) const {
  const std::pair<const char*, int64_t> classes[] = {
      {"positions", first_bad_row(model_.positions, 3)},
      {"log_scales", first_bad_row(model_.log_scales, 3)},
      {"rotations", first_bad_row(model_.rotations, 4)},
      {"opacity_logits", first_bad_row(model_.opacity_logits, 1)},
      {"sh", first_bad_row(model_.sh, 3 * kShCoefficients)},
      {"semantics", first_bad_row(model_.semantics, static_cast<size_t>(std::max(1, model_.semantic_channels)))}};
  for (const auto& [name, row] : classes) {
    if (row >= 0) return {true, row, name};
  }
  return symptom;
}

bool CpuEngine::render_neighbour(const StepRequest& request) {
  const TrainingView& view = views_[static_cast<size_t>(request.neighbour.view)];
  const RasterSettings raster = request.neighbour_raster();
  prepare_frame(view.data.camera, raster, request.sh_degree);
  if (frame_.view.non_finite >= 0) return false;
  forward_pass({frame_.view, frame_.lists, raster}, BlendedMaps::kLosses, *pool_, scratch_, frame_.maps, nullptr);
  keep_neighbour_depth<float>({frame_.maps, view, request.losses, pool_.get(), nullptr}, loss_workspace_);
  return true;
}

StepReport CpuEngine::step(const StepRequest& request) {
  check_step_request(request, views_.size());
  check_optimiser_settings(request);
  const TrainingView& view = views_[static_cast<size_t>(request.view)];
  const bool geometry = request.has_geometry_terms(), density = request.collect_density;
  StepReport report;
  Stopwatch watch(report.seconds);

  std::optional<NeighbourView<float>> neighbour;
  if (request.has_multi_view_terms()) {
    if (!render_neighbour(request)) {
      report.non_finite = locate({true, frame_.view.non_finite, "parameters"});
      return report;
    }
    neighbour.emplace(NeighbourView<float>{views_[static_cast<size_t>(request.neighbour.view)],
                                           loss_workspace_.neighbour_depth.data(), request.neighbour.seed});
    watch.lap("neighbour");
  }
  project_view(model_, view.data.camera, request.raster, request.sh_degree, *pool_, frame_.view);
  watch.lap("project");
  if (frame_.view.non_finite >= 0) {
    report.non_finite = locate({true, frame_.view.non_finite, "parameters"});
    return report;
  }
  build_tile_lists(frame_.view, *pool_, frame_.lists);
  watch.lap("bin");
  const bool semantics = semantics_active(request);
  const bool probabilities = request.losses.semantic_blend == SemanticBlend::kProbabilities;
  const bool rounded = semantics && products_ != SemanticProducts::kFloat32 && matrix_tiles_available();

  const ViewTiles tiles{frame_.view, frame_.lists, request.raster};
  forward_pass(tiles, geometry ? BlendedMaps::kLosses : BlendedMaps::kColor, *pool_, scratch_, frame_.maps,
               &frame_.record);
  report.visible = mark_touched(frame_.lists, frame_.record, *pool_, gradients_.touched);
  watch.lap("forward");
  if (semantics) {
    const bool renewed = rounded && prepare_rounded(request.losses.semantic_blend);
    const bool exact = !rounded || keep_features_;
    if (exact) prepare_features(request.losses.semantic_blend, gradients_.touched.data());
    // no such stage where the last step left the rows as they are needed
    if (renewed || exact) watch.lap("semantic_rows");
  }
  const MapLossInputs<float> inputs{
      frame_.maps, view, request.losses, pool_.get(), &loss_workspace_, neighbour ? &*neighbour : nullptr};
  clear_gradients(frame_.maps.pixels(), *pool_, map_gradients_);
  map_losses(inputs, report.losses, map_gradients_);
  if (density) color_residual(inputs, residual_);
  watch.lap("losses");

  // The factor of the bounded coupling comes from earlier steps; this step's values enter the balance at its end.
  const bool bounded = is_balanced(request.losses.coupling);
  const float strength = request.losses.coupling_strength;
  SemanticPass pass;
  if (semantics) {
    const size_t padded = padded_channels(model_.semantic_channels);
    feature_gradients_.resize(frame_.lists.visible.size() * padded);
    pass.step = {&view,
                 &semantic_views_[static_cast<size_t>(request.view)],
                 &request.losses,
                 &counts_,
                 model_.semantic_channels,
                 padded,
                 strength != 0};
    pass.rank = frame_.lists.rank.data();
    pass.features = frame_.features.data();
    pass.rounded = rounded ? rounded_.data() : nullptr;
    pass.gradients = feature_gradients_.data();
    pass.written = &feature_written_;
    pass.visible = frame_.lists.visible.size();
  }
  for (TileScratch& s : scratch_) s.semantic_seconds = 0;
  const bool prior = !view.data.prior_depth.empty();
  backward_pass(tiles, frame_.record,
                {map_gradients_, residual_.data(), prior ? view.data.prior_depth.data.data() : nullptr,
                 request.losses.prior_depth_scale},
                geometry, density, semantics ? &pass : nullptr, *pool_, scratch_, batches_, slots_);
  watch.lap("backward");
  if (semantics) {
    double seconds = 0;
    for (const TileScratch& s : scratch_) seconds += s.semantic_seconds;
    seconds /= static_cast<double>(scratch_.size());
    report.seconds["semantics"] = seconds;
    report.seconds["backward"] -= seconds;
    report.losses.add(Loss::kSemanticSoft, request.losses.weight[Loss::kSemanticSoft], pass.soft);
    report.losses.add(Loss::kSemanticHard, request.losses.weight[Loss::kSemanticHard], pass.hard);
  }
  last_semantics_ = semantics;
  last_probabilities_ = probabilities;

  report.coupling_scale = !semantics ? 0.0 : bounded ? coupling_factor(strength, balance_) : double(strength);
  const ParameterGradientInputs inputs_of_rows{
      model_, frame_.view, frame_.lists,   frame_.record,
      slots_, request,     report.visible, static_cast<float>(report.coupling_scale)};
  ParameterGradientTotals totals;
  const BadGradient bad = parameter_gradients(inputs_of_rows, *pool_, report.losses, totals, gradients_);
  watch.lap("parameter_gradients");
  if (const char* term = non_finite_loss(report.losses)) {
    report.non_finite = locate({true, -1, term});
    return report;
  }
  if (bad.row >= 0) {
    report.non_finite = locate({true, bad.row, bad.term});
    return report;
  }
  if (semantics && !pass.harmless) {
    const int64_t row = first_bad_feature_gradient();
    if (row >= 0) {
      report.non_finite = locate({true, row, "semantics"});
      return report;
    }
  }

  if (request.pose_gradient) {
    report.pose = pose_gradient(model_, gradients_, view.data.camera, request.sh_degree, *pool_);
    watch.lap("pose");
  }
  SemanticGradients semantic_gradients;
  if (semantics) {
    semantic_gradients = {frame_.lists.rank.data(),
                          feature_written_.data(),
                          feature_gradients_.data(),
                          probabilities,
                          probabilities && !rounded ? frame_.features.data() : nullptr,
                          counts_.last_log_count(),
                          rounded ? rounded_.data() : nullptr};
  }
  if (!rounded) rounded_for_.reset();  // rows that this step changes are not rounded again
  model_.sh_degree = request.sh_degree;
  optimise(request, gradients_, semantic_gradients, frame_.view, *pool_, model_, moments_for_step());
  if (density) add_density_statistics(inputs_of_rows, gradients_, *pool_, statistics_);
  if (semantics && bounded && strength != 0) {
    update_coupling_balance(totals.photometric_rms, totals.coupling_rms, balance_);
  }
  watch.lap("optimise");
  return report;
}

int64_t CpuEngine::first_bad_feature_gradient() const {
  const size_t n = model_.size(), padded = padded_channels(model_.semantic_channels);
  std::vector<int64_t> bad((n + kEngineRowsPerTask - 1) / kEngineRowsPerTask, -1);
  pool_->parallel_for(n, kEngineRowsPerTask, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end && bad[begin / kEngineRowsPerTask] < 0; ++i) {
      if (frame_.view.rects[i].area() == 0 || feature_written_[frame_.lists.rank[i]] == 0) continue;
      if (!all_within(feature_gradients_.data() + frame_.lists.rank[i] * padded, padded, kGradientLimit)) {
        bad[begin / kEngineRowsPerTask] = static_cast<int64_t>(i);
      }
    }
  });
  for (const int64_t row : bad) {
    if (row >= 0) return row;
  }
  return -1;
}

}  // namespace aligngs::cpu

namespace aligngs {

std::unique_ptr<Engine> make_cpu_engine(int threads) { return std::make_unique<cpu::CpuEngine>(threads); }

}  // namespace aligngs
