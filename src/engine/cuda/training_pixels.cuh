// Single pixels of a training view and of blended maps, as the losses read them.
#pragma once

#include "engine/cuda/training_maps.h"
#include "engine/cuda/view_spans.h"
#include "engine/formulas/depth_terms.h"

namespace aligngs::cuda {

__device__ __forceinline__ bool pixel_counts(const TrainingMapSpans& view, size_t pixel) {
  return (view.flags[pixel] & kPixelCounts) != 0;
}

/// The photo: what was divided by 255 when it was read is divided by 255 here.
__device__ __forceinline__ float truth_at(const TrainingMapSpans& view, size_t i) {
  return view.color_bytes.empty() ? view.color[i] : float(view.color_bytes[i]) / 255.0f;
}

__device__ __forceinline__ Vec3<float> vector_at(DeviceSpan<const float> planes, size_t pixel, size_t pixels) {
  return {planes[pixel], planes[pixels + pixel], planes[2 * pixels + pixel]};
}

/// The plane depth of a pixel and how far it can be trusted; nothing under the mask.
__device__ __forceinline__ DepthSample<float> depth_sample_at(const RenderMapSpans& maps, const TrainingMapSpans& view,
                                                              bool paper_normals, size_t pixel) {
  if (!pixel_counts(view, pixel)) return {};
  const size_t width = static_cast<size_t>(maps.width);
  const Vec3<float> ray = view.rays(static_cast<int>(pixel % width), static_cast<int>(pixel / width));
  const Vec3<float> n = vector_at(maps.normal, pixel, view.flags.size);
  const float distance = maps.distance[pixel], alpha = maps.alpha[pixel];
  const float z = paper_normals ? plane_depth_paper(n, distance, ray).z
                                : distance * plane_slope(n.x, n.y, n.z, alpha, distance, ray.x, ray.y).inverse;
  return judge_depth(z, alpha, maps.expected[pixel]);
}

}  // namespace aligngs::cuda
