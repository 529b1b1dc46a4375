// The pixel terms (losses/terms/pixel_term.h) at one pixel of the first and the last pass (map_terms.cuh,
// map_gradients.cuh).
#pragma once

#include "engine/cuda/map_term_inputs.cuh"

namespace aligngs::cuda {

template <unsigned kNeeds>
__device__ __forceinline__ TermPixel<float> term_pixel(const MapTermInputs& in, float depth, uint8_t validity,
                                                       size_t i) {
  TermPixel<float> pixel;
  if constexpr ((kNeeds & kNeedsDepth) != 0) {
    pixel.depth = depth;
    pixel.validity = validity;
  }
  if constexpr ((kNeeds & kNeedsUnitNormal) != 0) {
    const UnitNormal<float> unit = unit_normal_at(in, i);
    pixel.direction = unit.direction;
    pixel.inverse_length = unit.inverse_length;
  }
  if constexpr ((kNeeds & kNeedsPriorDepth) != 0) pixel.prior_depth = in.view.prior_depth[i];
  if constexpr ((kNeeds & kNeedsPriorNormal) != 0)
    pixel.prior_normal = vector_at(in.view.prior_normal, i, pixels_of(in));
  pixel.confidence = depth_weight_at(in.view, i);
  return pixel;
}

/// The term has a weight and the view its inputs.
template <class Term>
__device__ __forceinline__ bool acts(const MapTermInputs& in) {
  constexpr unsigned kNeeds = kLossCatalogue[index_of(Term::kLoss)].needs;
  return in.settings.weight[Term::kLoss] != 0 && in.view.given().suffice(kNeeds);
}

template <class Term>
__device__ __forceinline__ void measure_pixel_term(const MapTermInputs& in, float depth, uint8_t validity, size_t i,
                                                   float* sums) {
  if (!acts<Term>(in)) return;
  constexpr unsigned kNeeds = kLossCatalogue[index_of(Term::kLoss)].needs;
  const Term term(in.settings);
  const TermPixel<float> pixel = term_pixel<kNeeds>(in, depth, validity, i);
  const float weight = term.weight(pixel);
  if (!(weight > 0)) return;
  sums[kTermPixels] = 1;
  sums[kTermWeight] = weight;
  sums[kTermValue] = term.at(pixel, weight, 0.0f).value;
}
/// sums[terms][PixelTermSum]: of one pixel.
template <int kFirst, template <class> class... Terms>
__device__ __forceinline__ void measure_pixel_terms(PixelTermList<kFirst, Terms...>, const MapTermInputs& in,
                                                    float depth, uint8_t validity, size_t i, float* sums) {
  ((measure_pixel_term<Terms<float>>(in, depth, validity, i, sums), sums += kSumsPerTerm), ...);
}

/// s[terms][PixelTermSum]: over all pixels.
template <int kFirst, template <class> class... Terms>
__device__ __forceinline__ void finish_pixel_terms(PixelTermList<kFirst, Terms...>, const LossSettings& settings,
                                                   double pixels, const double* s, MeasuredTerms& m) {
  const float weights[] = {settings.weight[Terms<float>::kLoss]...};
  for (size_t k = 0; k < sizeof...(Terms); ++k, s += kSumsPerTerm) {
    if (!enough_valid(s[kTermPixels], pixels)) continue;
    m.values[k] = s[kTermValue] / s[kTermWeight];
    m.steps[k] = static_cast<float>(weights[k] / s[kTermWeight]);
  }
}
template <int kFirst, template <class> class... Terms>
__device__ __forceinline__ void add_pixel_values(PixelTermList<kFirst, Terms...>, const LossSettings& settings,
                                                 const MeasuredTerms& m, LossTerms& terms) {
  const double* value = m.values;
  (terms.add(Terms<float>::kLoss, settings.weight[Terms<float>::kLoss], *value++), ...);
}

template <class Term>
__device__ __forceinline__ void add_pixel_gradient(const MapTermInputs& in, float step, float depth, uint8_t validity,
                                                   size_t i, float& by_depth, Vec3<float>& by_normal) {
  if (step == 0) return;
  constexpr unsigned kNeeds = kLossCatalogue[index_of(Term::kLoss)].needs;
  const Term term(in.settings);
  const TermPixel<float> pixel = term_pixel<kNeeds>(in, depth, validity, i);
  const TermValue<float> v = term.at(pixel, term.weight(pixel), step);
  if constexpr ((kNeeds & kNeedsDepth) != 0) by_depth += v.by_depth;
  if constexpr ((kNeeds & kNeedsUnitNormal) != 0) by_normal += v.by_normal;
}
template <int kFirst, template <class> class... Terms>
__device__ __forceinline__ void add_pixel_gradients(PixelTermList<kFirst, Terms...>, const MapTermInputs& in,
                                                    const MeasuredTerms& m, float depth, uint8_t validity, size_t i,
                                                    float& by_depth, Vec3<float>& by_normal) {
  const float* step = m.steps;
  (add_pixel_gradient<Terms<float>>(in, *step++, depth, validity, i, by_depth, by_normal), ...);
}

}  // namespace aligngs::cuda
