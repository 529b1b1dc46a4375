// Structural similarity (Wang et al. 2004) as splatting papers use it: per channel, 11 x 11 Gaussian window
// with sigma 1.5, zero padding, population moments.
#pragma once

#include <cstdint>

#include "core/image.h"
#include "core/thread_pool.h"
#include "engine/formulas/photometric.h"
#include "engine/losses/workspace.h"

namespace aligngs {

/// Planar images of 3 channels and equal size; `mask` is null or H x W with values > 0.5 where pixels count.
template <class T>
struct SsimInputs {
  const T* render = nullptr;
  const T* truth = nullptr;
  const ImageF* mask = nullptr;
  int width = 0, height = 0;
  ThreadPool* pool = nullptr;
};

/// Mean SSIM over pixels that count and channels. With gradient != null adds weight * d(1 - SSIM) / d render
/// to it (planar, 3 planes), zero at pixels that do not count. `counted` is the number of pixels that count,
/// at least 1. Uses workspace.ssim_gradients and row_sums.
template <class T>
double ssim(const SsimInputs<T>& inputs, size_t counted, T weight, MapLossWorkspace<T>& workspace, T* gradient);

}  // namespace aligngs
