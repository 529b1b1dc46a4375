// Kernels of photometric.h: SSIM with separable windows in shared memory. One pass forms the values and the derivatives
// by the local moments, one the gradient.
#include "engine/cuda/photometric.h"

#include "device/constants.h"
#include "device/device_language.h"
#include "device/launch.h"
#include "engine/cuda/partial_sums.cuh"
#include "engine/cuda/training_pixels.cuh"
#include "engine/formulas/photometric.h"
#include "engine/losses/terms/l1.h"

namespace aligngs::cuda {

inline constexpr int kSsimThreads = kSsimTile * kSsimTile;
inline constexpr int kSsimPatch = kSsimTile + 2 * kSsimHalf;  ///< the square with its windows
inline constexpr int kSsimMoments = 5, kSsimGradients = 3;

enum PhotometricSum { kSumAbsolute, kSumSquared, kSumSsim, kPhotometricSums };

struct PhotometricInputs {
  RenderMapSpans maps;
  TrainingMapSpans view;
  SsimWindow<float> window;
  bool ssim = false;      ///< SSIM is wanted
  float l1_step = 0;      ///< L1 weight / (3 counted)
  float ssim_factor = 0;  ///< -SSIM weight / (3 counted)
};

/// The render as the losses take it: the photo replaces it under the mask.
__device__ __forceinline__ float render_at(const PhotometricInputs& in, size_t plane, size_t pixel, float truth) {
  return pixel_counts(in.view, pixel) ? in.maps.color[plane + pixel] : truth;
}

/// Sum of 11 products; p is the middle one, `stride` the step between them.
__device__ __forceinline__ float convolve(const float* p, int stride, const SsimWindow<float>& w) {
  float sum = w.tap[0] * p[0];
#pragma unroll
  for (int k = 1; k <= kSsimHalf; ++k) sum += w.tap[k] * (p[-k * stride] + p[k * stride]);
  return sum;
}
__device__ __forceinline__ float convolve(const float* p, const float* q, const SsimWindow<float>& w) {
  float sum = w.tap[0] * (p[0] * q[0]);
#pragma unroll
  for (int k = 1; k <= kSsimHalf; ++k) sum += w.tap[k] * (p[-k] * q[-k] + p[k] * q[k]);
  return sum;
}

/// The pixel of element i of the patch of this block, or -1 outside the image.
__device__ __forceinline__ int64_t patch_pixel(int i, int width, int height) {
  const int x = static_cast<int>(blockIdx.x) * kSsimTile - kSsimHalf + i % kSsimPatch;
  const int y = static_cast<int>(blockIdx.y) * kSsimTile - kSsimHalf + i / kSsimPatch;
  return x >= 0 && y >= 0 && x < width && y < height ? int64_t(y) * width + x : -1;
}

/// blockIdx.z: channel. derivatives[9][H W]: of SSIM by its moments, channel after channel, 0 under the mask.
__global__ void __launch_bounds__(kSsimThreads)
    photometric_forward_kernel(PhotometricInputs in, DeviceSpan<float> derivatives, DeviceSpan<double> partial) {
  __shared__ float render[kSsimPatch * kSsimPatch], truth[kSsimPatch * kSsimPatch];
  __shared__ float rows[kSsimMoments][kSsimPatch * kSsimTile];
  const int thread = static_cast<int>(threadIdx.x), channel = static_cast<int>(blockIdx.z);
  const size_t pixels = size_t(in.maps.width) * in.maps.height, plane = size_t(channel) * pixels;
  for (int i = thread; i < kSsimPatch * kSsimPatch; i += kSsimThreads) {
    const int64_t pixel = patch_pixel(i, in.maps.width, in.maps.height);
    const float t = pixel >= 0 ? truth_at(in.view, plane + static_cast<size_t>(pixel)) : 0.0f;
    truth[i] = t;
    render[i] = pixel >= 0 ? render_at(in, plane, static_cast<size_t>(pixel), t) : 0.0f;
  }
  __syncthreads();
  if (in.ssim) {
    for (int i = thread; i < kSsimPatch * kSsimTile; i += kSsimThreads) {
      const int at = i / kSsimTile * kSsimPatch + i % kSsimTile + kSsimHalf;
      const float *x = render + at, *y = truth + at;
      rows[0][i] = convolve(x, 1, in.window);
      rows[1][i] = convolve(y, 1, in.window);
      rows[2][i] = convolve(x, x, in.window);
      rows[3][i] = convolve(y, y, in.window);
      rows[4][i] = convolve(x, y, in.window);
    }
    __syncthreads();
  }
  const int column = thread % kSsimTile, row = thread / kSsimTile,
            centre = (row + kSsimHalf) * kSsimPatch + column + kSsimHalf;
  const int64_t pixel = patch_pixel(centre, in.maps.width, in.maps.height);
  float sums[kPhotometricSums] = {};
  if (pixel >= 0) {
    const size_t u = static_cast<size_t>(pixel);
    const bool counts = pixel_counts(in.view, u);
    if (counts) {
      const ColorDifference<float> d = color_difference(render[centre], truth[centre], 0.0f);
      sums[kSumAbsolute] = d.absolute;
      sums[kSumSquared] = d.squared;
    }
    if (in.ssim) {
      const int at = (row + kSsimHalf) * kSsimTile + column;
      const SsimSample<float> s = ssim_sample<float>(
          {convolve(rows[0] + at, kSsimTile, in.window), convolve(rows[1] + at, kSsimTile, in.window),
           convolve(rows[2] + at, kSsimTile, in.window), convolve(rows[3] + at, kSsimTile, in.window),
           convolve(rows[4] + at, kSsimTile, in.window)});
      if (counts) sums[kSumSsim] = s.value;
      const size_t to = size_t(kSsimGradients) * plane + u;
      derivatives[to] = counts ? s.d_x : 0.0f;
      derivatives[to + pixels] = counts ? s.d_xx : 0.0f;
      derivatives[to + 2 * pixels] = counts ? s.d_xy : 0.0f;
    }
  }
  store_partial_sums(sums, partial);
}

/// Writes the gradient of every pixel and channel, and the residual unless empty.
__global__ void __launch_bounds__(kSsimThreads)
    photometric_backward_kernel(PhotometricInputs in, DeviceSpan<const float> derivatives, DeviceSpan<float> gradient,
                                DeviceSpan<float> residual) {
  __shared__ float patch[kSsimGradients][kSsimPatch * kSsimPatch];
  __shared__ float rows[kSsimGradients][kSsimPatch * kSsimTile];
  const int thread = static_cast<int>(threadIdx.x);
  const size_t pixels = size_t(in.maps.width) * in.maps.height;
  const int column = thread % kSsimTile, row = thread / kSsimTile;
  const int64_t own = patch_pixel((row + kSsimHalf) * kSsimPatch + column + kSsimHalf, in.maps.width, in.maps.height);
  const size_t u = static_cast<size_t>(own < 0 ? 0 : own);
  const bool inside = own >= 0, counts = inside && pixel_counts(in.view, u);
  float difference = 0;
  for (int channel = 0; channel < 3; ++channel) {
    const size_t plane = size_t(channel) * pixels;
    float blurred[kSsimGradients] = {};
    if (in.ssim) {
      for (int i = thread; i < kSsimPatch * kSsimPatch; i += kSsimThreads) {
        const int64_t pixel = patch_pixel(i, in.maps.width, in.maps.height);
        for (int k = 0; k < kSsimGradients; ++k) {
          patch[k][i] =
              pixel >= 0 ? derivatives[size_t(kSsimGradients) * plane + size_t(k) * pixels + static_cast<size_t>(pixel)]
                         : 0.0f;
        }
      }
      __syncthreads();
      for (int i = thread; i < kSsimPatch * kSsimTile; i += kSsimThreads) {
        const int at = i / kSsimTile * kSsimPatch + i % kSsimTile + kSsimHalf;
        for (int k = 0; k < kSsimGradients; ++k) rows[k][i] = convolve(patch[k] + at, 1, in.window);
      }
      __syncthreads();
      const int at = (row + kSsimHalf) * kSsimTile + column;
      for (int k = 0; k < kSsimGradients; ++k) blurred[k] = convolve(rows[k] + at, kSsimTile, in.window);
      __syncthreads();
    }
    if (!inside) continue;
    const float truth = truth_at(in.view, plane + u);
    const ColorDifference<float> d = color_difference(in.maps.color[plane + u], truth, in.l1_step);
    float g = d.gradient;
    if (in.ssim) {
      g += in.ssim_factor * ssim_gradient(blurred[0], blurred[1], blurred[2], in.maps.color[plane + u], truth);
    }
    gradient[plane + u] = counts ? g : 0.0f;
    difference += d.absolute;
  }
  if (inside && !residual.empty()) residual[u] = counts ? difference / 3.0f : 0.0f;
}

/// Starts the terms of the step.
__global__ void __launch_bounds__(kSumThreads)
    finish_photometric_kernel(LossSettings settings, uint32_t counted, DeviceSpan<const double> partial,
                              DeviceSpan<LossTerms> terms) {
  double sums[kPhotometricSums];
  load_partial_sums(partial, sums);
  if (threadIdx.x != 0) return;
  LossTerms t{};
  if (counted > 0) {
    const double scale = 1.0 / (3.0 * counted);
    t.psnr = psnr_of(sums[kSumSquared] * scale);
    if (settings.weight[Loss::kL1] != 0) t.add(Loss::kL1, settings.weight[Loss::kL1], sums[kSumAbsolute] * scale);
    if (settings.weight[Loss::kSsim] != 0) t.add(Loss::kSsim, settings.weight[Loss::kSsim], 1 - sums[kSumSsim] * scale);
  }
  terms[0] = t;
}

void photometric_losses(DeviceArena& arena, const MapLossSpans& in, const MapLossOutputs& out) {
  const DeviceContext& context = arena.context();
  const size_t pixels = size_t(in.maps.width) * in.maps.height;
  const double scale = in.view.counted > 0 ? 1.0 / (3.0 * in.view.counted) : 0.0;
  PhotometricInputs p;
  p.maps = in.maps;
  p.view = in.view;
  p.window = gaussian_window<float>();
  p.ssim = in.settings.weight[Loss::kSsim] != 0;
  p.l1_step = static_cast<float>(in.settings.weight[Loss::kL1] * scale);
  p.ssim_factor = static_cast<float>(-in.settings.weight[Loss::kSsim] * scale);
  const dim3 tiles(static_cast<unsigned>((in.maps.width + kSsimTile - 1) / kSsimTile),
                   static_cast<unsigned>((in.maps.height + kSsimTile - 1) / kSsimTile), 3);
  const size_t blocks = size_t(tiles.x) * tiles.y * tiles.z;
  const DeviceSpan<double> partial = arena.take<double>(kPhotometricSums * blocks, "photometric sums");
  const DeviceSpan<float> derivatives =
      arena.take<float>(p.ssim ? 3 * kSsimGradients * pixels : 0, "derivatives of SSIM");
  launch(context, "photometric_forward", photometric_forward_kernel, {tiles, dim3(kSsimThreads), 0}, p, derivatives,
         partial);
  launch(context, "finish_photometric", finish_photometric_kernel, {dim3(1), dim3(kSumThreads), 0}, in.settings,
         in.view.counted, partial, out.terms);
  launch(context, "photometric_backward", photometric_backward_kernel, {dim3(tiles.x, tiles.y), dim3(kSsimThreads), 0},
         p, derivatives, out.gradients.color, out.residual);
}

uint64_t photometric_scratch_bytes(const LossSettings& settings, size_t pixels) {
  // Blocks of kSsimThreads leave one sum each per term; the rest of a tile at the border is small.
  uint64_t bytes = uint64_t(3 * kPhotometricSums) * (pixels / kSsimThreads + 1) * sizeof(double);
  if (settings.weight[Loss::kSsim] != 0) bytes += uint64_t(3 * kSsimGradients) * pixels * sizeof(float);
  return bytes;
}

}  // namespace aligngs::cuda
