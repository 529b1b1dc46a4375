#include "engine/losses/ssim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/target_clones.h"
#include "engine/losses/ordered_sum.h"
#include "engine/losses/row_parallel.h"

namespace aligngs {
namespace {

constexpr int kMoments = 5;    // E[x], E[y], E[xx], E[yy], E[xy]
constexpr int kGradients = 3;  // dSSIM / dE[x], dE[xx], dE[xy]

// The rows y - 5 .. y + 5 of a plane; rows outside are a row of zeros.
template <class T>
using RowPointers = std::array<const T*, kSsimTaps>;

template <class T>
RowPointers<T> rows_around(const T* plane, int y, int width, int height, const T* zeros) {
  RowPointers<T> rows;
  for (int k = 0; k < kSsimTaps; ++k) {
    const int row = y + k - kSsimHalf;
    rows[k] = row >= 0 && row < height ? plane + static_cast<size_t>(row) * width : zeros;
  }
  return rows;
}

// Rows of moments or gradients with kSsimHalf zeros on either side, one after the other.
inline size_t padded(int width) { return static_cast<size_t>(width) + 2 * kSsimHalf; }

// Sum of 11 products, written out so that the loop over pixels is the one that gets vectorised.
template <class T>
ALIGNGS_ALWAYS_INLINE T convolve(const T* p, const SsimWindow<T>& w) {
  return w.tap[0] * p[5] + w.tap[1] * (p[4] + p[6]) + w.tap[2] * (p[3] + p[7]) + w.tap[3] * (p[2] + p[8]) +
         w.tap[4] * (p[1] + p[9]) + w.tap[5] * (p[0] + p[10]);
}

template <class T>
ALIGNGS_ALWAYS_INLINE T convolve(const RowPointers<T>& r, int i, const SsimWindow<T>& w) {
  return w.tap[0] * r[5][i] + w.tap[1] * (r[4][i] + r[6][i]) + w.tap[2] * (r[3][i] + r[7][i]) +
         w.tap[3] * (r[2][i] + r[8][i]) + w.tap[4] * (r[1][i] + r[9][i]) + w.tap[5] * (r[0][i] + r[10][i]);
}

// The same for the products of two rows.
template <class T>
ALIGNGS_ALWAYS_INLINE T convolve(const RowPointers<T>& a, const RowPointers<T>& b, int i, const SsimWindow<T>& w) {
  return w.tap[0] * (a[5][i] * b[5][i]) + w.tap[1] * (a[4][i] * b[4][i] + a[6][i] * b[6][i]) +
         w.tap[2] * (a[3][i] * b[3][i] + a[7][i] * b[7][i]) + w.tap[3] * (a[2][i] * b[2][i] + a[8][i] * b[8][i]) +
         w.tap[4] * (a[1][i] * b[1][i] + a[9][i] * b[9][i]) + w.tap[5] * (a[0][i] * b[0][i] + a[10][i] * b[10][i]);
}

template <class T>
ALIGNGS_ALWAYS_INLINE void moments_of_columns(RowPointers<T> x, RowPointers<T> y, int width, const SsimWindow<T>& w,
                                              T* __restrict ex, T* __restrict ey, T* __restrict exx, T* __restrict eyy,
                                              T* __restrict exy) {
  for (int i = 0; i < width; ++i) {
    ex[i] = convolve(x, i, w);
    ey[i] = convolve(y, i, w);
    exx[i] = convolve(x, x, i, w);
    eyy[i] = convolve(y, y, i, w);
    exy[i] = convolve(x, y, i, w);
  }
}

// SSIM of one row from its padded moments, and its derivatives by the moments of x.
template <class T>
ALIGNGS_ALWAYS_INLINE void ssim_of_row(const T* moments, int width, const SsimWindow<T>& w, T* __restrict value,
                                       T* __restrict d_ex, T* __restrict d_exx, T* __restrict d_exy) {
  const size_t stride = padded(width);
  for (int i = 0; i < width; ++i) {
    const SsimSample<T> sample = ssim_sample<T>(
        {convolve(moments + i, w), convolve(moments + stride + i, w), convolve(moments + 2 * stride + i, w),
         convolve(moments + 3 * stride + i, w), convolve(moments + 4 * stride + i, w)});
    value[i] = sample.value;
    d_ex[i] = sample.d_x;
    d_exx[i] = sample.d_xx;
    d_exy[i] = sample.d_xy;
  }
}

template <class T>
ALIGNGS_ALWAYS_INLINE void blur_columns(RowPointers<T> rows, int width, const SsimWindow<T>& w, T* __restrict out) {
  for (int i = 0; i < width; ++i) out[i] = convolve(rows, i, w);
}

template <class T>
ALIGNGS_ALWAYS_INLINE void gradient_of_row(const T* blurred, const T* x, const T* y, int width, const SsimWindow<T>& w,
                                           T scale, T* __restrict gradient) {
  const size_t stride = padded(width);
  for (int i = 0; i < width; ++i) {
    const T g = ssim_gradient(convolve(blurred + i, w), convolve(blurred + stride + i, w),
                              convolve(blurred + 2 * stride + i, w), x[i], y[i]);
    gradient[i] += scale * g;
  }
}

template <class T>
ALIGNGS_ALWAYS_INLINE void forward_of_row(const RowPointers<T>& x, const RowPointers<T>& y, int width,
                                          const SsimWindow<T>& w, T* moments, T* value, T* d_ex, T* d_exx, T* d_exy) {
  const size_t stride = padded(width);
  T* first = moments + kSsimHalf;
  moments_of_columns<T>(x, y, width, w, first, first + stride, first + 2 * stride, first + 3 * stride,
                        first + 4 * stride);
  ssim_of_row<T>(moments, width, w, value, d_ex, d_exx, d_exy);
}

template <class T>
ALIGNGS_ALWAYS_INLINE void backward_of_row(const RowPointers<T>* rows, const T* x, const T* y, int width,
                                           const SsimWindow<T>& w, T scale, T* blurred, T* gradient) {
  const size_t stride = padded(width);
  for (int k = 0; k < kGradients; ++k) blur_columns<T>(rows[k], width, w, blurred + k * stride + kSsimHalf);
  gradient_of_row<T>(blurred, x, y, width, w, scale, gradient);
}

// Compiled per instruction set: function versions cannot be templates.
ALIGNGS_TARGET_CLONES
void row_forward(const RowPointers<float>& x, const RowPointers<float>& y, int width, const SsimWindow<float>& w,
                 float* moments, float* value, float* d_ex, float* d_exx, float* d_exy) {
  forward_of_row<float>(x, y, width, w, moments, value, d_ex, d_exx, d_exy);
}
void row_forward(const RowPointers<double>& x, const RowPointers<double>& y, int width, const SsimWindow<double>& w,
                 double* moments, double* value, double* d_ex, double* d_exx, double* d_exy) {
  forward_of_row<double>(x, y, width, w, moments, value, d_ex, d_exx, d_exy);
}
ALIGNGS_TARGET_CLONES
void row_backward(const RowPointers<float>* rows, const float* x, const float* y, int width, const SsimWindow<float>& w,
                  float scale, float* blurred, float* gradient) {
  backward_of_row<float>(rows, x, y, width, w, scale, blurred, gradient);
}
void row_backward(const RowPointers<double>* rows, const double* x, const double* y, int width,
                  const SsimWindow<double>& w, double scale, double* blurred, double* gradient) {
  backward_of_row<double>(rows, x, y, width, w, scale, blurred, gradient);
}

}  // namespace

template <class T>
double ssim(const SsimInputs<T>& in, size_t counted, T weight, MapLossWorkspace<T>& workspace, T* gradient) {
  const int width = in.width, height = in.height;
  const size_t pixels = static_cast<size_t>(width) * height;
  const SsimWindow<T> window = gaussian_window<T>();
  const std::vector<T> zeros(static_cast<size_t>(width), T(0));
  workspace.ssim_gradients.resize(3 * kGradients * pixels);
  T* const derivatives = workspace.ssim_gradients.data();
  const auto plane = [&](int channel, int k) { return derivatives + (kGradients * channel + k) * pixels; };

  const auto forward_row = [&](int task) {
    const int channel = task / height, y = task % height;
    const size_t row = static_cast<size_t>(y) * width;
    thread_local std::vector<T> scratch;
    scratch.assign(kMoments * padded(width) + static_cast<size_t>(width), T(0));
    T* value = scratch.data() + kMoments * padded(width);
    T *d_ex = plane(channel, 0) + row, *d_exx = plane(channel, 1) + row, *d_exy = plane(channel, 2) + row;
    row_forward(rows_around(in.render + channel * pixels, y, width, height, zeros.data()),
                rows_around(in.truth + channel * pixels, y, width, height, zeros.data()), width, window, scratch.data(),
                value, d_ex, d_exx, d_exy);
    if (in.mask) {
      for (int x = 0; x < width; ++x) {
        if (in.mask->data[row + x] > 0.5f) continue;
        value[x] = d_ex[x] = d_exx[x] = d_exy[x] = T(0);
      }
    }
    return std::array<double, 1>{ordered_sum(value, width)};
  };
  const double total = sum_rows<1>(in.pool, 3 * height, workspace.row_sums, forward_row)[0];
  const double scale = 1.0 / (3.0 * static_cast<double>(counted));

  if (gradient) {
    const T factor = static_cast<T>(-static_cast<double>(weight) * scale);
    for_each_row(in.pool, 3 * height, [&](int task) {
      const int channel = task / height, y = task % height;
      const size_t row = channel * pixels + static_cast<size_t>(y) * width;
      thread_local std::vector<T> scratch;
      scratch.assign(kGradients * padded(width) + static_cast<size_t>(width), T(0));
      RowPointers<T> rows[kGradients];
      for (int k = 0; k < kGradients; ++k) {
        rows[k] = rows_around<T>(plane(channel, k), y, width, height, zeros.data());
      }
      if (!in.mask) {
        row_backward(rows, in.render + row, in.truth + row, width, window, factor, scratch.data(), gradient + row);
        return;
      }
      T* masked = scratch.data() + kGradients * padded(width);
      row_backward(rows, in.render + row, in.truth + row, width, window, factor, scratch.data(), masked);
      for (int x = 0; x < width; ++x) {
        if (in.mask->data[static_cast<size_t>(y) * width + x] > 0.5f) gradient[row + x] += masked[x];
      }
    });
  }
  return total * scale;
}

template double ssim<float>(const SsimInputs<float>&, size_t, float, MapLossWorkspace<float>&, float*);
template double ssim<double>(const SsimInputs<double>&, size_t, double, MapLossWorkspace<double>&, double*);

}  // namespace aligngs
