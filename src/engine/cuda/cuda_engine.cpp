#include "engine/cuda/cuda_engine.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "device/constants.h"
#include "engine/cuda/blend_forward.h"
#include "engine/cuda/make_engine.h"
#include "engine/cuda/map_losses.h"
#include "engine/cuda/optimiser.h"
#include "engine/cuda/pose_gradient.h"
#include "engine/cuda/project.h"
#include "engine/cuda/semantic_rows.h"
#include "engine/cuda/shape_terms.h"
#include "engine/shared/optimiser_settings.h"

namespace aligngs::cuda {
namespace {

size_t room_for(size_t pairs) { return static_cast<size_t>(static_cast<double>(pairs) * kPairGrowth) + kPairSlack; }

}  // namespace

CudaEngine::CudaEngine(int device, uint64_t budget_bytes, int threads, const CudaEngineOptions& options)
    : options_(options),
      context_(std::make_unique<DeviceContext>(device, budget_bytes)),
      pool_(std::make_unique<ThreadPool>(threads)),
      name_("cuda:" + std::to_string(device) + ", " + context_->facts().name),
      arena_(*context_),
      read_back_(std::make_unique<PinnedMemory>(*context_, sizeof(ReadBack))),
      timer_(std::make_unique<StageTimer>(*context_, options.time_stages)),
      graph_(std::make_unique<StepGraph>(*context_, options.graphs)) {}

DeviceFrame CudaEngine::make_frame(const FrameRequest& request) const {
  const auto mark = [&](const char* stage) {
    if (request.stages) timer_->mark(stage);
  };
  arena_.reset();
  DeviceFrame frame = take_frame(arena_, request.camera, request.raster, model_.size(), request.geometry);
  project_view(*context_, {model_.spans(), request.raster, request.sh_degree}, frame.view, frame.bad);
  mark("project");
  size_t room = room_for(request.pairs);
  if (request.pairs == 0) {
    count_tile_pairs(*context_, frame.view, frame.counts);
    BinCounts counts;
    download(*context_, &counts, frame.counts);
    room = request.record ? room_for(counts.instances) : counts.instances;  // as much as at the next visit, or once
    if (counts.instances > 0xffffffffull) {
      throw_resources({}, std::to_string(counts.instances) + " (Gaussian, tile) pairs in one view",
                      "limit the size of the Gaussians (scale limit) or their number");
    }
  }
  take_lists(arena_, room, request.record, frame);
  build_tile_lists(arena_, frame.view, frame.lists, frame.counts, frame.bad);
  mark("bin");
  return frame;
}

CudaEngine::ViewOnDevice* CudaEngine::neighbour_of(const StepRequest& request) {
  return request.has_multi_view_terms() ? &views_[static_cast<size_t>(request.neighbour.view)] : nullptr;
}

NeighbourSpans CudaEngine::render_neighbour(const StepRequest& request, const ViewOnDevice& view) {
  const ViewOnDevice* other = neighbour_of(request);
  if (other == nullptr) return {};
  const RasterSettings raster = request.neighbour_raster();
  const DeviceFrame frame = make_frame({other->camera, raster, request.sh_degree, true, false, other->pairs, false});
  blend_forward(*context_, {frame.view, frame.lists, raster, true}, frame.maps, frame.record);
  // The step still needs this depth after the arena's next reset.
  neighbour_depth_.resize(*context_, frame.maps.alpha.size, "the depth of a neighbouring view");
  neighbour_bad_.resize(*context_, 1, "state of the step");
  const TrainingMapSpans maps = other->maps.spans();
  keep_neighbour_depth(*context_, frame.maps, maps, request.losses.paper_normals, neighbour_depth_.span());
  copy(*context_, neighbour_bad_.span(), frame.bad);
  context_->copy_to_host_later(&static_cast<ReadBack*>(read_back_->data())->neighbour_counts, frame.counts.data,
                               sizeof(BinCounts));
  timer_->mark("neighbour");
  return {TwoViews<float>(view.camera, other->camera), maps, neighbour_depth_.span(), request.neighbour.seed};
}

bool CudaEngine::semantics_active(const StepRequest& request, const ViewOnDevice& view) const {
  if (model_.channels() == 0 || view.teacher_channels != model_.channels()) return false;
  if (map_.remainder() != active_.remainder()) return false;  // a model of another number of classes
  if (!request.losses.has(LossStage::kSemantics)) return false;
  return view.teacher.spans().valid > 0;
}

CudaEngine::SemanticStep CudaEngine::visit_semantics(const StepRequest& request, const ViewOnDevice& view) {
  const DeviceFrame& frame = last_.frame;
  const size_t padded = static_cast<size_t>(padded_channels(model_.channels())), pairs = frame.lists.gaussians.size;
  const size_t tiles = frame.lists.tile_begin.size - 1;
  const bool couple = request.losses.coupling_strength != 0;
  const DeviceSpan<uint16_t> rows = arena_.take<uint16_t>(model_.size() * padded, "rounded semantic rows");
  const SemanticRowInputs row_inputs{model_.spans(), last_.touched, frame.lists.rank, request.losses.semantic_blend,
                                     map_.remainder()};
  semantic_rows(*context_, row_inputs, rows);
  timer_->mark("semantic_rows");
  SemanticStep step;
  step.row_slots = arena_.take<float>(pairs * padded, "semantic gradients of (Gaussian, tile) pairs");
  step.seen = arena_.take<uint8_t>(pairs, "semantic record");
  step.terms = arena_.take<double>(kSemanticTerms, "semantic losses");
  if (couple) step.coupling = arena_.take<CouplingMoments>(pairs, "coupling of (Gaussian, tile) pairs");
  SemanticVisitInputs in;
  in.view = frame.view;
  in.lists = frame.lists;
  in.record = frame.record;
  in.teacher = view.teacher.spans();
  in.rows = rows;
  in.raster = request.raster;
  in.blend = request.losses.semantic_blend;
  in.coupling = request.losses.coupling;
  in.couple = couple;
  in.soft_weight = request.losses.weight[Loss::kSemanticSoft];
  in.hard_weight = request.losses.weight[Loss::kSemanticHard];
  in.remainder = map_.remainder();
  in.sample = request.losses.semantic_sample;
  in.method = options_.semantic_visit;
  semantic_visit(*context_, in,
                 {step.row_slots, step.coupling, step.seen,
                  arena_.take<double>(kSemanticTerms * tiles, "semantic losses of tiles"), step.terms});
  last_.semantic_gradients = arena_.take<float>(model_.size() * padded, "semantic gradients");
  last_.semantic_written = arena_.take<uint8_t>(model_.size(), "semantic gradients");
  semantic_gradients(*context_, {row_inputs, frame.lists, step.row_slots, step.seen},
                     {last_.semantic_gradients, last_.semantic_written, frame.bad});
  timer_->mark("semantics");
  return step;
}

void CudaEngine::enqueue_step(const StepRequest& request, const ViewOnDevice& view, float coupling_scale) {
  const LossSettings& losses = request.losses;
  const bool geometry = request.has_geometry_terms(), density = request.collect_density;
  const size_t n = model_.size();
  last_ = {};
  timer_->start();
  last_.semantics = semantics_active(request, view);
  const NeighbourSpans neighbour = render_neighbour(request, view);
  last_.frame = make_frame({view.camera, request.raster, request.sh_degree, geometry, true, view.pairs});
  if (options_.blend_backward == BlendBackwardMethod::kPerSplat) take_checkpoints(arena_, geometry, last_.frame);
  const DeviceFrame& frame = last_.frame;
  const size_t pixels = frame.maps.alpha.size, pairs = frame.lists.gaussians.size;
  blend_forward(*context_, {frame.view, frame.lists, request.raster, geometry}, frame.maps, frame.record);
  last_.touched = arena_.take<uint8_t>(n, "touched rows");
  const DeviceSpan<uint32_t> visible = arena_.take<uint32_t>(1, "state of the step");
  mark_touched(*context_, frame.lists, frame.record, last_.touched, visible);
  timer_->mark("forward");

  MapGradientSpans gradients;
  gradients.color = arena_.take<float>(3 * pixels, "gradients of colour");
  if (geometry) {
    gradients.normal = arena_.take<float>(3 * pixels, "gradients of normals");
    gradients.distance = arena_.take<float>(pixels, "gradients of distances");
    gradients.alpha = arena_.take_zeroed<float>(pixels, "gradients of alpha");
  }
  const DeviceSpan<float> residual = arena_.take<float>(density ? pixels : 0, "colour residual");
  const DeviceSpan<LossTerms> terms = arena_.take<LossTerms>(1, "losses");
  const TrainingMapSpans training = view.maps.spans();
  map_losses(arena_, {frame.maps, training, losses, neighbour}, {gradients, residual, terms});
  timer_->mark("losses");

  const DeviceSpan<SplatGradient> slots = arena_.take<SplatGradient>(pairs, "gradients of (Gaussian, tile) pairs");
  blend_backward(*context_,
                 {frame.view, frame.lists, frame.record, gradients, residual,
                  density ? training.prior_depth : DeviceSpan<const float>{}, losses.prior_depth_scale, request.raster,
                  geometry, density, options_.blend_backward, frame.maps},
                 slots);
  timer_->mark("backward");
  SemanticStep semantic;
  if (last_.semantics) semantic = visit_semantics(request, view);

  ModelSpans& g = last_.gradients;
  g.gaussians = n;
  g.positions = arena_.take<float>(3 * n, "gradients");
  g.log_scales = arena_.take<float>(3 * n, "gradients");
  g.rotations = arena_.take<float>(4 * n, "gradients");
  g.opacity_logits = arena_.take<float>(n, "gradients");
  g.sh = arena_.take<float>(size_t(3) * kShCoefficients * n, "gradients");
  const DeviceSpan<DensitySums> density_sums = arena_.take<DensitySums>(density ? n : 0, "density sums");
  const DeviceSpan<double> squares = arena_.take<double>(kGradientSquares, "state of the step");
  parameter_gradients(*context_,
                      {model_.spans(), frame.view, frame.lists, frame.record, last_.touched, slots, semantic.coupling,
                       semantic.seen, coupling_scale, request.sh_degree, request.raster.dropout.factor()},
                      {g, density_sums, squares, arena_.take<double>(square_scratch(n), "sums of squares"), frame.bad});
  add_shape_terms(arena_, {model_.spans(), last_.touched, visible, losses, request.extent}, {g, terms, frame.bad});
  timer_->mark("parameter_gradients");
  DeviceSpan<PoseGradient<double>> pose;
  if (request.pose_gradient) {
    pose = arena_.take<PoseGradient<double>>(1, "state of the step");
    pose_gradient(arena_, {model_.spans(), g, last_.touched, pose_frame<float>(view.camera), request.sh_degree}, pose);
    timer_->mark("pose");
  }

  last_.outcome = arena_.take<StepOutcome>(1, "state of the step");
  StepOutcomeInputs judged;
  judged.terms = terms;
  judged.semantic_terms = semantic.terms;
  judged.squares = squares;
  judged.bad = frame.bad;
  if (!neighbour.empty()) judged.neighbour_bad = neighbour_bad_.span();
  judged.visible = visible;
  judged.soft_weight = losses.weight[Loss::kSemanticSoft];
  judged.hard_weight = losses.weight[Loss::kSemanticHard];
  judge_step(*context_, judged, last_.outcome);
  const DeviceSpan<const uint32_t> blocked = blocked_of(last_.outcome);
  optimise(*context_, request,
           {g, last_.touched, last_.semantic_gradients, last_.semantic_written, frame.lists.rank, blocked},
           {model_.spans(), m_.spans(), v_.spans(), semantic_updates_.span()},
           std::max(sh_used_, size_t(3) * static_cast<size_t>(sh_coefficient_count(request.sh_degree))));
  if (density) {
    add_density_statistics(*context_, {frame.view, last_.touched, density_sums, blocked}, density_spans());
  }
  timer_->mark("optimise");

  auto* back = static_cast<ReadBack*>(read_back_->data());
  context_->copy_to_host_later(&back->outcome, last_.outcome.data, sizeof(StepOutcome));
  context_->copy_to_host_later(&back->counts, frame.counts.data, sizeof(BinCounts));
  if (request.pose_gradient) context_->copy_to_host_later(&back->pose, pose.data, sizeof(PoseGradient<double>));
}

CudaEngine::ReadBack CudaEngine::run_step(const StepRequest& request, const ViewOnDevice& view, float coupling_scale) {
  const auto enqueue = [&] { enqueue_step(request, view, coupling_scale); };
  const ViewOnDevice* neighbour = neighbour_of(request);
  static_cast<ReadBack*>(read_back_->data())->neighbour_counts = {};
  static_cast<ReadBack*>(read_back_->data())->pose = {};
  if (graph_->on() && view.pairs != 0 && (neighbour == nullptr || neighbour->pairs != 0)) {
    arena_.reset();  // may give memory back and take it, which a capture cannot
    graph_->run(enqueue);
  } else {
    enqueue();
  }
  context_->synchronise();
  return *static_cast<const ReadBack*>(read_back_->data());
}

StepReport CudaEngine::step(const StepRequest& request) {
  check_step_request(request, views_.size());
  check_optimiser_settings(request);
  const auto start = std::chrono::steady_clock::now();
  ViewOnDevice& view = views_[static_cast<size_t>(request.view)];
  const bool semantics = semantics_active(request, view);
  const bool bounded = is_balanced(request.losses.coupling);
  const float strength = request.losses.coupling_strength;
  StepReport report;
  const auto attempt = [&] {
    const ReadBack back = run_step(request, view, static_cast<float>(report.coupling_scale));
    timer_->read(report.seconds);
    return back;
  };
  // The factor of the bounded coupling comes from earlier steps; this step's values enter the balance at its end.
  report.coupling_scale = !semantics ? 0.0 : bounded ? coupling_factor(strength, balance_) : double(strength);
  ViewOnDevice* neighbour = neighbour_of(request);
  const auto learn_pairs = [&](const ReadBack& back) {
    view.pairs = std::max<size_t>(1, back.counts.instances);
    if (neighbour != nullptr) neighbour->pairs = std::max<size_t>(1, back.neighbour_counts.instances);
  };
  ReadBack back = attempt();
  learn_pairs(back);
  if (back.counts.overflow != 0 || back.neighbour_counts.overflow != 0) {  // nothing was written
    back = attempt();
    learn_pairs(back);
  }
  report.losses = back.outcome.terms;
  report.visible = back.outcome.visible;
  if (!timer_->on()) {
    report.seconds["step"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  if (back.outcome.blocked != 0) {
    report.non_finite = locate(symptom_of(back.outcome));
    return report;
  }
  report.pose = back.pose;
  sh_degree_ = request.sh_degree;
  sh_used_ = std::max(sh_used_, size_t(3) * static_cast<size_t>(sh_coefficient_count(request.sh_degree)));
  if (semantics && bounded && strength != 0) {
    const GradientScale scale = gradient_scale(back.outcome);
    update_coupling_balance(scale.photometric_rms, scale.coupling_rms, balance_);
  }
  return report;
}

NonFinite CudaEngine::locate(NonFinite symptom) const {
  const NonFinite cause = find_bad_parameter(arena_, model_.spans());
  return cause.found ? cause : symptom;
}

GaussianModel CudaEngine::last_gradients() const {
  GaussianModel g;
  g.semantic_channels = model_.channels();
  g.resize(model_.size());
  const ModelSpans& from = last_.gradients;
  if (from.gaussians != model_.size() || from.gaussians == 0) return g;
  download(*context_, g.positions.data(), from.positions);
  download(*context_, g.log_scales.data(), from.log_scales);
  download(*context_, g.rotations.data(), from.rotations);
  download(*context_, g.opacity_logits.data(), from.opacity_logits);
  download(*context_, g.sh.data(), from.sh);
  constexpr size_t kShRow = size_t(3) * kShCoefficients;
  const size_t n = model_.size(), channels = static_cast<size_t>(model_.channels());
  std::vector<uint8_t> touched(n), written(last_.semantics ? n : 0);
  std::vector<uint32_t> rank(n);
  std::vector<float> semantic(last_.semantic_gradients.size);
  download(*context_, touched.data(), last_.touched);
  download(*context_, rank.data(), last_.frame.lists.rank);
  if (last_.semantics) {
    download(*context_, written.data(), last_.semantic_written);
    download(*context_, semantic.data(), last_.semantic_gradients);
  }
  const size_t padded = static_cast<size_t>(padded_channels(model_.channels()));
  for (size_t i = 0; i < n; ++i) {
    if (touched[i] == 0) std::fill_n(g.sh.begin() + static_cast<ptrdiff_t>(kShRow * i), kShRow, 0.0f);
    if (!last_.semantics || written[i] == 0) continue;
    std::copy_n(semantic.begin() + static_cast<ptrdiff_t>(rank[i] * padded), channels,
                g.semantics.begin() + static_cast<ptrdiff_t>(channels * i));
  }
  return g;
}

RenderMaps<float> CudaEngine::last_maps() const {
  RenderMaps<float> out;
  const RenderMapSpans& m = last_.frame.maps;
  out.width = m.width;
  out.height = m.height;
  const auto fetch = [&](DeviceSpan<float> from, std::vector<float>& to) {
    to.resize(from.size);
    download(*context_, to.data(), from);
  };
  fetch(m.color, out.color);
  fetch(m.alpha, out.alpha);
  fetch(m.normal, out.normal);
  fetch(m.distance, out.distance);
  fetch(m.expected, out.expected);
  fetch(m.median, out.median);
  return out;
}

}  // namespace aligngs::cuda

namespace aligngs {

std::unique_ptr<Engine> make_cuda_engine(int index, uint64_t budget_bytes, int threads,
                                         const cuda::CudaEngineOptions& options) {
  return std::make_unique<cuda::CudaEngine>(index, budget_bytes, threads, options);
}

}  // namespace aligngs
