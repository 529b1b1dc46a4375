#include "engine/losses/photometric.h"

#include <algorithm>
#include <cmath>

#include "core/target_clones.h"
#include "engine/losses/ordered_sum.h"
#include "engine/losses/row_parallel.h"
#include "engine/losses/ssim.h"
#include "engine/losses/terms/l1.h"

namespace aligngs {
namespace {

bool counts(const ImageF& mask, size_t pixel) { return mask.empty() || mask.data[pixel] > 0.5f; }

// One row of the photo in planes, and, with a mask, of the render with the photo under it.
template <class T>
void prepare_row(const MapLossInputs<T>& in, int y, MapLossWorkspace<T>& workspace) {
  const size_t pixels = in.maps.pixels();
  const ImageF& mask = in.view.data.mask;
  const size_t begin = static_cast<size_t>(y) * in.maps.width, end = begin + in.maps.width;
  for (int c = 0; c < 3; ++c) {
    T* truth = workspace.truth.data() + c * pixels;
    const float* source = in.view.data.color.data.data() + c;
    for (size_t i = begin; i < end; ++i) truth[i] = static_cast<T>(source[3 * i]);
    if (mask.empty()) continue;
    for (size_t i = begin; i < end; ++i) {
      workspace.masked_render[c * pixels + i] = counts(mask, i) ? in.maps.color[c * pixels + i] : truth[i];
    }
  }
}

// One row: |d| and the squared difference as shown (clamped to [0, 1]), and the gradient of the L1 term.
template <class T>
ALIGNGS_ALWAYS_INLINE void differences_of_row(const T* render, const T* truth, int width, T step,
                                              T* __restrict absolute, T* __restrict squared, T* __restrict gradient) {
  for (int x = 0; x < width; ++x) {
    const ColorDifference<T> d = color_difference(render[x], truth[x], step);
    absolute[x] = d.absolute;
    squared[x] = d.squared;
    gradient[x] += d.gradient;
  }
}

ALIGNGS_TARGET_CLONES
void row_differences(const float* render, const float* truth, int width, float step, float* absolute, float* squared,
                     float* gradient) {
  differences_of_row<float>(render, truth, width, step, absolute, squared, gradient);
}
void row_differences(const double* render, const double* truth, int width, double step, double* absolute,
                     double* squared, double* gradient) {
  differences_of_row<double>(render, truth, width, step, absolute, squared, gradient);
}

}  // namespace

template <class T>
void photometric_losses(const MapLossInputs<T>& in, MapLossWorkspace<T>& workspace, LossTerms& terms,
                        MapGradients<T>& gradients) {
  const int width = in.maps.width, height = in.maps.height;
  const size_t pixels = in.maps.pixels();
  const ImageF& mask = in.view.data.mask;
  const size_t counted =
      mask.empty()
          ? pixels
          : static_cast<size_t>(std::count_if(mask.data.begin(), mask.data.end(), [](float m) { return m > 0.5f; }));
  if (counted == 0) return;
  workspace.truth.resize(3 * pixels);
  workspace.masked_render.resize(mask.empty() ? 0 : 3 * pixels);
  const T* render = mask.empty() ? in.maps.color.data() : workspace.masked_render.data();

  const double scale = 1.0 / (3.0 * static_cast<double>(counted));
  const T step = static_cast<T>(static_cast<double>(in.settings.weight[Loss::kL1]) * scale);
  // L1 row by row while the row laid out for SSIM is in the cache. It is not part of SSIM's own rounds, which go by
  // channel. Its sum would have another order there, and a setting without SSIM would need this one as well.
  const auto [absolute_sum, squared_sum] = sum_rows<2>(in.pool, height, workspace.row_sums, [&](int y) {
    prepare_row(in, y, workspace);
    thread_local std::vector<T> scratch;
    scratch.resize(2 * static_cast<size_t>(width));
    T *absolute = scratch.data(), *squared = absolute + width;
    double of_absolute = 0, of_squared = 0;
    for (int c = 0; c < 3; ++c) {
      const size_t row = c * pixels + static_cast<size_t>(y) * width;
      row_differences(render + row, workspace.truth.data() + row, width, step, absolute, squared,
                      gradients.color.data() + row);
      of_absolute += ordered_sum(absolute, width);
      of_squared += ordered_sum(squared, width);
    }
    return std::array<double, 2>{of_absolute, of_squared};
  });
  terms.psnr = psnr_of(squared_sum * scale);
  if (in.settings.weight[Loss::kL1] != 0) {
    terms.add(Loss::kL1, in.settings.weight[Loss::kL1], absolute_sum * scale);
  }
  if (in.settings.weight[Loss::kSsim] != 0) {
    const SsimInputs<T> similarity{render, workspace.truth.data(), mask.empty() ? nullptr : &mask, width, height,
                                   in.pool};
    const double loss = 1 - ssim(similarity, counted, static_cast<T>(in.settings.weight[Loss::kSsim]), workspace,
                                 gradients.color.data());
    terms.add(Loss::kSsim, in.settings.weight[Loss::kSsim], loss);
  }
}

template <class T>
void color_residual(const MapLossInputs<T>& in, std::vector<float>& residual) {
  const size_t pixels = in.maps.pixels();
  residual.resize(pixels);
  for_each_row(in.pool, in.maps.height, [&](int y) {
    const size_t begin = static_cast<size_t>(y) * in.maps.width, end = begin + in.maps.width;
    for (size_t i = begin; i < end; ++i) {
      T sum = 0;
      for (int c = 0; c < 3; ++c) {
        sum += std::abs(in.maps.color[c * pixels + i] - static_cast<T>(in.view.data.color.data[3 * i + c]));
      }
      residual[i] = counts(in.view.data.mask, i) ? static_cast<float>(sum / T(3)) : 0.0f;
    }
  });
}

template void photometric_losses<float>(const MapLossInputs<float>&, MapLossWorkspace<float>&, LossTerms&,
                                        MapGradients<float>&);
template void photometric_losses<double>(const MapLossInputs<double>&, MapLossWorkspace<double>&, LossTerms&,
                                         MapGradients<double>&);
template void color_residual<float>(const MapLossInputs<float>&, std::vector<float>&);
template void color_residual<double>(const MapLossInputs<double>&, std::vector<float>&);

}  // namespace aligngs
