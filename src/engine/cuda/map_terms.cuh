// Losses on depth and normals in three passes over the pixels. Terms are normalised by the number of pixels that take
// part. One pass measures, the next one compares neighbours, and the last one forms the gradients with the known
// normalisations. A pixel gathers the gradients of its neighbours' terms. Nothing is scattered, so sums have a fixed
// order.
#pragma once

#include "engine/cuda/constants.h"
#include "engine/cuda/map_losses.h"
#include "engine/cuda/partial_sums.cuh"
#include "engine/cuda/runtime/device_language.h"
#include "engine/cuda/training_pixels.cuh"
#include "engine/formulas/depth_terms.h"
#include "engine/formulas/label_edges.h"
#include "engine/formulas/normal_terms.h"

namespace aligngs::cuda {

/// Known after the first pass.
struct MeasuredTerms {
  bool pearson = false;  ///< enough pixels take part
  double pearson_count = 0, mean_rendered = 0, mean_prior = 0;
  double log_depth = 0, prior_normal = 0;           ///< values
  float log_depth_step = 0, prior_normal_step = 0;  ///< factors of the gradients; 0: none
};
/// Known after the second.
struct ComparedTerms {
  PearsonResult pearson;
  double consistency = 0, boundary = 0, crease = 0;  ///< values
  float consistency_step = 0;                        ///< factors of the gradients; 0: none
  double boundary_step = 0, crease_step = 0;
};

struct MapTermInputs {
  RenderMapSpans maps;
  TrainingMapSpans view;
  LossSettings settings;
};
/// [H W] each.
struct MapTermScratch {
  DeviceSpan<float> depth;
  DeviceSpan<uint8_t> validity, stencil;
  DeviceSpan<float4> neighbours;  ///< dL_ng/dz of the stencil's right, left, top, bottom neighbour; where stencil != 0
  DeviceSpan<MeasuredTerms> measured;  ///< [1]
  DeviceSpan<ComparedTerms> compared;  ///< [1]
};

enum MeasuredSum {
  kPearsonCount,
  kPearsonRendered,
  kPearsonPrior,
  kLogCount,
  kLogWeight,
  kLogValue,
  kPriorNormalCount,
  kPriorNormalWeight,
  kPriorNormalValue,
  kMeasuredSums
};
enum ComparedSum {
  kPearsonRenderedSquares,
  kPearsonPriorSquares,
  kPearsonProducts,
  kConsistencyCount,
  kConsistencyValue,
  kBoundaryCount,
  kBoundaryValue,
  kCreaseWeight,
  kCreaseValue,
  kComparedSums
};

__device__ __forceinline__ size_t pixels_of(const MapTermInputs& in) { return in.view.flags.size; }

__device__ __forceinline__ UnitNormal<float> unit_normal_at(const MapTermInputs& in, size_t pixel) {
  return unit_normal_of(vector_at(in.maps.normal, pixel, pixels_of(in)), in.maps.alpha[pixel],
                        pixel_counts(in.view, pixel));
}
__device__ __forceinline__ float depth_weight_at(const TrainingMapSpans& view, size_t pixel) {
  return view.depth_weight.empty() ? 1.0f : view.depth_weight[pixel];
}
__device__ __forceinline__ float prior_depth_at(const TrainingMapSpans& view, size_t pixel) {
  return view.prior_depth.empty() ? 0.0f : view.prior_depth[pixel];
}
/// Pixels that L_d correlates.
__device__ __forceinline__ bool in_pearson(const MapTermInputs& in, uint8_t validity, size_t pixel) {
  return validity != kDepthInvalid && (in.view.flags[pixel] & kPixelLabelEdge) == 0 &&
         prior_depth_at(in.view, pixel) > 0;
}
__device__ __forceinline__ float huber_delta(const LossSettings& s) {
  const double delta = s.log_depth_huber;
  return static_cast<float>(delta > kHuberMinimum ? delta : kHuberMinimum);
}
__device__ __forceinline__ float log_depth_weight_at(const MapTermInputs& in, uint8_t validity, size_t pixel) {
  return in.settings.prior_depth_scale > 0
             ? log_depth_weight(validity, prior_depth_at(in.view, pixel), depth_weight_at(in.view, pixel))
             : 0.0f;
}

// ---- pass 1: depth, and the terms of single pixels ----

__global__ void __launch_bounds__(kPixelThreads)
    measure_kernel(MapTermInputs in, MapTermScratch scratch, DeviceSpan<double> partial) {
  const size_t i = item_index(), pixels = pixels_of(in);
  float sums[kMeasuredSums] = {};
  if (i < pixels) {
    const DepthSample<float> sample = depth_sample_at(in.maps, in.view, in.settings.paper_normals, i);
    const uint8_t validity = static_cast<uint8_t>(sample.level);
    scratch.depth[i] = sample.z;
    scratch.validity[i] = validity;
    if (in.settings.pearson_weight != 0 && in_pearson(in, validity, i)) {
      sums[kPearsonCount] = 1;
      sums[kPearsonRendered] = sample.z;
      sums[kPearsonPrior] = in.view.prior_depth[i];
    }
    if (in.settings.log_depth_weight != 0) {
      const float weight = log_depth_weight_at(in, validity, i);
      if (weight > 0) {
        sums[kLogCount] = 1;
        sums[kLogWeight] = weight;
        sums[kLogValue] = log_depth_term(sample.z, in.view.prior_depth[i], weight, in.settings.prior_depth_scale,
                                         huber_delta(in.settings), 0.0f)
                              .value;
      }
    }
    if (in.settings.prior_normal_weight != 0 && !in.view.prior_normal.empty()) {
      const UnitNormal<float> unit = unit_normal_at(in, i);
      const Vec3<float> prior = vector_at(in.view.prior_normal, i, pixels);
      const PriorNormalTerm<float> term = prior_normal_term(unit.direction, unit.inverse_length, prior.x, prior.y,
                                                            prior.z, depth_weight_at(in.view, i));
      sums[kPriorNormalCount] = term.weight > 0 ? 1 : 0;
      sums[kPriorNormalWeight] = term.weight;
      sums[kPriorNormalValue] = term.value;
    }
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
  if (enough_valid(s[kLogCount], pixels)) {
    m.log_depth = s[kLogValue] / s[kLogWeight];
    m.log_depth_step = static_cast<float>(in.settings.log_depth_weight / s[kLogWeight]);
  }
  if (enough_valid(s[kPriorNormalCount], pixels)) {
    m.prior_normal = s[kPriorNormalValue] / s[kPriorNormalWeight];
    m.prior_normal_step = static_cast<float>(-in.settings.prior_normal_weight / s[kPriorNormalWeight]);
  }
  out[0] = m;
}

// ---- pairs across label edges ----

/// The pair whose first pixel is (x, y), or none; dx, dy: (1, 0) or (0, 1).
struct EdgeAt {
  uint8_t flags = 0;
  __device__ bool pair(int dx) const { return (flags & (dx != 0 ? kPixelRightPair : kPixelLowerPair)) != 0; }
  __device__ bool crease(int dx) const { return (flags & (dx != 0 ? kPixelRightCrease : kPixelLowerCrease)) != 0; }
  __device__ bool coplanar(int dx) const {
    return (flags & (dx != 0 ? kPixelRightCoplanar : kPixelLowerCoplanar)) != 0;
  }
};
__device__ __forceinline__ EdgeAt edge_at(const MapTermInputs& in, int x, int y) {
  if (x < 0 || y < 0 || x >= in.maps.width || y >= in.maps.height) return {};
  return {in.view.flags[size_t(y) * in.maps.width + x]};
}

/// A pair that L_nb looks at: both directions known and, by default, an unbroken surface.
__device__ __forceinline__ bool in_boundary(const MapTermInputs& in, const MapTermScratch& scratch, size_t u,
                                            size_t v) {
  return in.settings.paper_normals ||
         unbroken_depth(scratch.depth[u], scratch.validity[u], scratch.depth[v], scratch.validity[v]);
}

/// Steps from the first pixel of a pair to where the crease loss reads the prior and the render, on either side.
inline constexpr int kPriorOut = kCreasePriorOffset - 1, kRenderOut = kCreaseRenderOffset - 1;

/// The smaller weight of the two prior pixels of the pair that begins at u.
__device__ __forceinline__ float crease_weight(const MapTermInputs& in, size_t u, size_t step) {
  const float before = depth_weight_at(in.view, u - kPriorOut * step);
  const float after = depth_weight_at(in.view, u + (kPriorOut + 1) * step);
  return before < after ? before : after;
}

// ---- pass 2: comparisons of neighbours ----

__device__ __forceinline__ void compare_depth_normal(const MapTermInputs& in, const MapTermScratch& scratch, int x,
                                                     int y, size_t i, DeviceSpan<float> d_normal,
                                                     float (&sums)[kComparedSums]) {
  const size_t pixels = pixels_of(in), width = static_cast<size_t>(in.maps.width);
  const UnitNormal<float> unit = unit_normal_at(in, i);
  DepthStencil stencil;
  if (unit.valid()) {
    stencil = depth_stencil(scratch.depth.data, scratch.validity.data, x, y, in.maps.width, in.maps.height,
                            in.settings.paper_normals);
  }
  NormalComparison<float> c{};
  if (stencil.valid()) {
    const Reach h = reach_of(stencil.horizontal), v = reach_of(stencil.vertical);
    const DepthNeighbours<float> neighbours{scratch.depth[i + h.after],
                                            scratch.depth[i - h.before],
                                            scratch.depth[i - v.before * width],
                                            scratch.depth[i + v.after * width],
                                            float(h.after),
                                            float(-h.before),
                                            float(-v.before),
                                            float(v.after),
                                            1.0f};
    const Vec3<float> ray = in.view.rays(x, y);
    c = compare_normals(neighbours, ray.x, ray.y, in.view.rays.step_x, in.view.rays.step_y, unit.direction,
                        unit.inverse_length, 1.0f);
    scratch.neighbours[i] = make_float4(c.d_right, c.d_left, c.d_top, c.d_bottom);
    sums[kConsistencyCount] = 1;
    sums[kConsistencyValue] = c.loss;
  }
  scratch.stencil[i] = stencil.valid() ? stencil.packed() : uint8_t(0);
  d_normal[i] = c.d_x;
  d_normal[pixels + i] = c.d_y;
  d_normal[2 * pixels + i] = c.d_z;
}

/// The terms of the pairs that begin at pixel i.
__device__ __forceinline__ void compare_pairs(const MapTermInputs& in, const MapTermScratch& scratch, int x, int y,
                                              size_t i, float (&sums)[kComparedSums]) {
  const EdgeAt edge = edge_at(in, x, y);
  if ((edge.flags & (kPixelRightPair | kPixelLowerPair)) == 0) return;
  const size_t pixels = pixels_of(in);
  for (int dx = 0; dx < 2; ++dx) {
    if (!edge.pair(dx)) continue;
    const size_t step = dx != 0 ? 1 : static_cast<size_t>(in.maps.width), v = i + step;
    if (in.settings.normal_boundary_weight != 0 && in_boundary(in, scratch, i, v)) {
      const UnitNormal<float> a = unit_normal_at(in, i), b = unit_normal_at(in, v);
      if (a.valid() && b.valid()) {
        sums[kBoundaryCount] += 1;
        sums[kBoundaryValue] += static_cast<float>(boundary_penalty(dot(a.direction, b.direction)));
      }
    }
    if (in.settings.crease_weight == 0) continue;
    if (edge.crease(dx)) {
      const float weight = crease_weight(in, i, step);
      const UnitNormal<float> a = unit_normal_at(in, i - kRenderOut * step),
                              b = unit_normal_at(in, v + kRenderOut * step);
      const Vec3<float> before = vector_at(in.view.prior_normal, i - kPriorOut * step, pixels),
                        after = vector_at(in.view.prior_normal, v + kPriorOut * step, pixels);
      sums[kCreaseWeight] += (a.valid() ? weight : 0) + (b.valid() ? weight : 0);
      if (a.valid()) sums[kCreaseValue] += weight * (1 - dot(a.direction, before));
      if (b.valid()) sums[kCreaseValue] += weight * (1 - dot(b.direction, after));
    } else if (edge.coplanar(dx)) {
      const float weight = crease_weight(in, i, step);
      const UnitNormal<float> a = unit_normal_at(in, i), b = unit_normal_at(in, v);
      if (a.valid() && b.valid()) {
        sums[kCreaseWeight] += weight;
        sums[kCreaseValue] += weight * (1 - dot(a.direction, b.direction));
      }
    }
  }
}

/// Leaves the gradient of L_ng by the pixel's own normal, not yet normalised, in d_normal.
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
    if (in.settings.normal_consistency_weight != 0) compare_depth_normal(in, scratch, x, y, i, d_normal, sums);
    if (in.settings.normal_boundary_weight != 0 || in.settings.crease_weight != 0) {
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
                               set.pearson_weight);
  }
  if (enough_valid(s[kConsistencyCount], pixels)) {
    c.consistency = s[kConsistencyValue] / s[kConsistencyCount];
    c.consistency_step = static_cast<float>(set.normal_consistency_weight / s[kConsistencyCount]);
  }
  if (s[kBoundaryCount] > 0) {
    c.boundary = s[kBoundaryValue] / s[kBoundaryCount];
    c.boundary_step = set.normal_boundary_weight / s[kBoundaryCount];
  }
  if (s[kCreaseWeight] > 0) {
    const double least = kCreaseMinimumShare * pixels, divisor = s[kCreaseWeight] > least ? s[kCreaseWeight] : least;
    c.crease = s[kCreaseValue] / divisor;
    c.crease_step = -set.crease_weight / divisor;
  }
  scratch.compared[0] = c;
  LossTerms& t = terms[0];
  t.pearson = c.pearson.loss;
  t.log_depth = m.log_depth;
  t.normal_consistency = c.consistency;
  t.normal_boundary = c.boundary;
  t.crease = c.crease;
  t.prior_normal = m.prior_normal;
  t.total += set.pearson_weight * t.pearson + set.log_depth_weight * t.log_depth +
             set.normal_consistency_weight * t.normal_consistency + set.normal_boundary_weight * t.normal_boundary +
             set.crease_weight * t.crease + set.prior_normal_weight * t.prior_normal;
}

}  // namespace aligngs::cuda
