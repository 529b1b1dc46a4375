#include "engine/cuda/map_losses.h"

#include "device/launch.h"
#include "engine/cuda/map_gradients.cuh"
#include "engine/cuda/map_terms.cuh"
#include "engine/cuda/photometric.h"

namespace aligngs::cuda {
namespace {

// Losses on depth and normals take three passes over the pixels, as terms are normalised by the number of pixels that
// take part. One pass measures, the next one compares neighbours, and the last one forms the gradients with the known
// normalisations. A pixel gathers the gradients of its neighbours' terms. Nothing is scattered, so sums have a fixed
// order.

/// Pass 1: depth, and the terms of single pixels.
__global__ void __launch_bounds__(kPixelThreads)
    measure_kernel(MapTermInputs in, MapTermScratch scratch, DeviceSpan<double> partial) {
  const size_t i = item_index(), pixels = pixels_of(in);
  float sums[kMeasuredSums] = {};
  if (i < pixels) {
    const DepthSample<float> sample = depth_sample_at(in.maps, in.view, in.settings.paper_normals, i);
    const uint8_t validity = static_cast<uint8_t>(sample.level);
    scratch.depth[i] = sample.z;
    scratch.validity[i] = validity;
    if (in.settings.weight[Loss::kPearson] != 0 && in_pearson(in, validity, i)) {
      sums[kPearsonCount] = 1;
      sums[kPearsonRendered] = sample.z;
      sums[kPearsonPrior] = in.view.prior_depth[i];
    }
    measure_pixel_terms(PixelTerms{}, in, sample.z, validity, i, sums + kPixelSums);
  }
  store_partial_sums(sums, partial);
}

__global__ void __launch_bounds__(kSumThreads)
    finish_measure_kernel(MapTermInputs in, DeviceSpan<const double> partial, DeviceSpan<MeasuredTerms> out) {
  double s[kMeasuredSums];
  load_partial_sums(partial, s);
  if (threadIdx.x != 0) return;
  const double pixels = static_cast<double>(pixels_of(in));
  MeasuredTerms m{};
  m.pearson = enough_for_pearson(s[kPearsonCount], pixels);
  if (m.pearson) {
    m.pearson_count = s[kPearsonCount];
    m.mean_rendered = s[kPearsonRendered] / s[kPearsonCount];
    m.mean_prior = s[kPearsonPrior] / s[kPearsonCount];
  }
  finish_pixel_terms(PixelTerms{}, in.settings, pixels, s + kPixelSums, m);
  out[0] = m;
}

/// Pass 2: comparisons of neighbours. Leaves the gradient of L_ng by the pixel's own normal, not yet normalised, in
/// d_normal.
__global__ void __launch_bounds__(kPixelThreads)
    compare_kernel(MapTermInputs in, MapTermScratch scratch, DeviceSpan<float> d_normal, DeviceSpan<double> partial) {
  const size_t i = item_index();
  float sums[kComparedSums] = {};
  if (i < pixels_of(in)) {
    const int x = static_cast<int>(i % static_cast<size_t>(in.maps.width));
    const int y = static_cast<int>(i / static_cast<size_t>(in.maps.width));
    const MeasuredTerms& m = scratch.measured[0];
    if (m.pearson && in_pearson(in, scratch.validity[i], i)) {
      const double a = static_cast<double>(scratch.depth[i]) - m.mean_rendered;
      const double b = static_cast<double>(in.view.prior_depth[i]) - m.mean_prior;
      sums[kPearsonRenderedSquares] = static_cast<float>(a * a);
      sums[kPearsonPriorSquares] = static_cast<float>(b * b);
      sums[kPearsonProducts] = static_cast<float>(a * b);
    }
    if (in.settings.weight[Loss::kNormalConsistency] != 0) compare_depth_normal(in, scratch, x, y, i, d_normal, sums);
    if (in.settings.weight[Loss::kNormalBoundary] != 0 || in.settings.weight[Loss::kCrease] != 0) {
      compare_pairs(in, scratch, x, y, i, sums);
    }
  }
  store_partial_sums(sums, partial);
}

__global__ void __launch_bounds__(kSumThreads)
    finish_compare_kernel(MapTermInputs in, DeviceSpan<const double> partial, MapTermScratch scratch,
                          DeviceSpan<LossTerms> terms) {
  double s[kComparedSums];
  load_partial_sums(partial, s);
  if (threadIdx.x != 0) return;
  const double pixels = static_cast<double>(pixels_of(in));
  const MeasuredTerms& m = scratch.measured[0];
  const LossSettings& set = in.settings;
  ComparedTerms c{};
  if (m.pearson) {
    c.pearson = pearson_result({m.pearson_count, m.mean_rendered, m.mean_prior, s[kPearsonRenderedSquares],
                                s[kPearsonPriorSquares], s[kPearsonProducts]},
                               set.weight[Loss::kPearson]);
  }
  if (enough_valid(s[kConsistencyCount], pixels)) {
    c.consistency = s[kConsistencyValue] / s[kConsistencyCount];
    c.consistency_step = static_cast<float>(set.weight[Loss::kNormalConsistency] / s[kConsistencyCount]);
  }
  if (s[kBoundaryCount] > 0) {
    c.boundary = s[kBoundaryValue] / s[kBoundaryCount];
    c.boundary_step = set.weight[Loss::kNormalBoundary] / s[kBoundaryCount];
  }
  if (s[kCreaseWeight] > 0) {
    const double least = kCreaseMinimumShare * pixels, divisor = s[kCreaseWeight] > least ? s[kCreaseWeight] : least;
    c.crease = s[kCreaseValue] / divisor;
    c.crease_step = -set.weight[Loss::kCrease] / divisor;
  }
  scratch.compared[0] = c;
  LossTerms& t = terms[0];
  t.add(Loss::kPearson, set.weight[Loss::kPearson], c.pearson.loss);
  add_pixel_values(PixelTerms{}, set, m, t);
  t.add(Loss::kNormalConsistency, set.weight[Loss::kNormalConsistency], c.consistency);
  t.add(Loss::kNormalBoundary, set.weight[Loss::kNormalBoundary], c.boundary);
  t.add(Loss::kCrease, set.weight[Loss::kCrease], c.crease);
}

/// Pass 3: the gradients. Writes normal and distance of every pixel.
__global__ void __launch_bounds__(kPixelThreads)
    map_gradient_kernel(MapTermInputs in, MapTermScratch scratch, MultiViewGradients views, MapGradientSpans out) {
  const size_t i = item_index(), pixels = pixels_of(in);
  if (i >= pixels) return;
  const int x = static_cast<int>(i % static_cast<size_t>(in.maps.width));
  const int y = static_cast<int>(i / static_cast<size_t>(in.maps.width));
  const MeasuredTerms& m = scratch.measured[0];
  const ComparedTerms& c = scratch.compared[0];
  const float depth = scratch.depth[i];
  const uint8_t validity = scratch.validity[i];

  float g = 0;
  Vec3<float> d_normal;
  if (c.consistency_step != 0) {
    g = c.consistency_step * gather_consistency(in, scratch, x, y, i);
    d_normal = vector_at(out.normal, i, pixels) * c.consistency_step;
  }
  Vec3<float> by_normal;  // of the pixel terms
  add_pixel_gradients(PixelTerms{}, in, m, depth, validity, i, g, by_normal);
  if (m.pearson && in_pearson(in, validity, i)) {
    g += static_cast<float>(c.pearson.along_rendered * (static_cast<double>(depth) - m.mean_rendered) -
                            c.pearson.along_prior * (static_cast<double>(in.view.prior_depth[i]) - m.mean_prior));
  }
  if (!views.depth.empty()) g += views.steps[0].geometric * views.depth[i];

  const Vec3<float> ray = in.view.rays(x, y), n = vector_at(in.maps.normal, i, pixels);
  const float distance = in.maps.distance[i];
  float d_distance = 0;
  if (!in.settings.paper_normals) {
    const PlaneSlope<float> slope = plane_slope(n.x, n.y, n.z, in.maps.alpha[i], distance, ray.x, ray.y);
    const DepthGradient<float> d = plane_depth_gradient(g, slope, distance);
    d_distance = d.distance;
    d_normal += ray * d.normal;
  } else if (g != 0) {
    const PlaneDepth<float> d = plane_depth_paper(n, distance, ray);
    d_distance = g * d.dz_ddistance;
    d_normal += d.dz_dnormal * g;
  }

  if (c.boundary_step != 0 || c.crease_step != 0) {
    const UnitNormal<float> unit = unit_normal_at(in, i);
    if (unit.valid()) d_normal += normal_gradient(unit, gather_pairs(in, scratch, c, unit, x, y, i));
  }
  d_normal += by_normal;
  if (!views.plane.empty()) {
    const float step = views.steps[0].photometric;
    d_normal += vector_at(views.plane, i, pixels) * step;
    d_distance += step * views.plane[3 * pixels + i];
  }
  out.distance[i] = d_distance;
  for (int k = 0; k < 3; ++k) out.normal[size_t(k) * pixels + i] = d_normal[k];
}

void geometry_losses(DeviceArena& arena, const MapLossSpans& in, const MapLossOutputs& out) {
  const DeviceContext& context = arena.context();
  const size_t pixels = size_t(in.maps.width) * in.maps.height;
  const MapTermInputs terms{in.maps, in.view, in.settings};
  const MapTermScratch scratch{
      arena.take<float>(pixels, "plane depth"),       arena.take<uint8_t>(pixels, "depth validity"),
      arena.take<uint8_t>(pixels, "depth stencils"),  arena.take<float4>(pixels, "gradients of depth normals"),
      arena.take<MeasuredTerms>(1, "measured terms"), arena.take<ComparedTerms>(1, "compared terms")};
  const LaunchShape shape = one_per_item(pixels, kPixelThreads), one{dim3(1), dim3(kSumThreads), 0};
  const DeviceSpan<double> measured = arena.take<double>(shape.grid.x * size_t(kMeasuredSums), "sums of the losses");
  const DeviceSpan<double> compared = arena.take<double>(shape.grid.x * size_t(kComparedSums), "sums of the losses");
  launch(context, "measure", measure_kernel, shape, terms, scratch, measured);
  launch(context, "finish_measure", finish_measure_kernel, one, terms, measured, scratch.measured);
  launch(context, "compare", compare_kernel, shape, terms, scratch, out.gradients.normal, compared);
  launch(context, "finish_compare", finish_compare_kernel, one, terms, compared, scratch, out.terms);
  MultiViewGradients views;
  if (!in.neighbour.empty() && in.settings.has(LossStage::kTwoViews)) {
    views = multi_view_losses(arena, {in.maps, in.view, in.settings, in.neighbour, scratch.depth, scratch.validity},
                              out.terms);
  }
  launch(context, "map_gradient", map_gradient_kernel, shape, terms, scratch, views, out.gradients);
}

}  // namespace

void map_losses(DeviceArena& arena, const MapLossSpans& in, const MapLossOutputs& out) {
  photometric_losses(arena, in, out);
  if (in.settings.has_geometry_terms(!in.neighbour.empty())) geometry_losses(arena, in, out);
}

uint64_t map_loss_scratch_bytes(const LossSettings& settings, size_t pixels) {
  uint64_t bytes = photometric_scratch_bytes(settings, pixels);
  if (settings.has_geometry_terms(true)) {
    bytes += multi_view_bytes(settings, pixels);
    bytes += uint64_t(pixels) * (sizeof(float) + 2 * sizeof(uint8_t) + sizeof(float4));
    // Blocks of kPixelThreads leave one sum each per term.
    bytes += (uint64_t(kMeasuredSums) + uint64_t(kComparedSums)) * (pixels / kPixelThreads + 1) * sizeof(double);
  }
  return bytes;
}

}  // namespace aligngs::cuda
