#include "metrics/image_metrics.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "core/error.h"
#include "metrics/undefined.h"

namespace aligngs {
namespace {

constexpr int kWindow = 11;  // pixels, Wang et al. 2004
constexpr int kRadius = kWindow / 2;
constexpr double kSigma = 1.5;       // pixels
constexpr double kC1 = 0.01 * 0.01;  // (K1 L)^2 with dynamic range L = 1
constexpr double kC2 = 0.03 * 0.03;
constexpr double kMinMse = 1e-10;  // kMaxPsnr
// Weight of the identity in the colour fit, as a share of the pixels: far below the noise of a photo, far above
// rounding.
constexpr double kIdentityWeight = 1e-6;

void require_same_size(const ImageF& a, const ImageF& b, const ImageF& mask) {
  if (a.width != b.width || a.height != b.height || a.channels != b.channels) {
    throw_bad_input({}, "image size",
                    fmt::format("a render of {}x{}x{} cannot be compared with an image of {}x{}x{}", a.width, a.height,
                                a.channels, b.width, b.height, b.channels),
                    "render at the camera of the image");
  }
  if (!mask.empty() && (mask.width != a.width || mask.height != a.height)) {
    throw_bad_input(
        {}, "mask",
        fmt::format("a mask of {}x{} does not fit an image of {}x{}", mask.width, mask.height, a.width, a.height));
  }
}

bool counts(const ImageF& mask, size_t pixel) { return mask.empty() || mask.data[pixel * mask.channels] >= 0.5f; }

/// Squared differences and how many there are.
struct SquaredError {
  double sum = 0;
  size_t count = 0;
};

/// Adds up the columns [begin_x, end_x).
SquaredError squared_error(const ImageF& a, const ImageF& b, const ImageF& mask, int begin_x, int end_x) {
  SquaredError error;
  for (int y = 0; y < a.height; ++y) {
    for (int x = begin_x; x < end_x; ++x) {
      if (!counts(mask, size_t(y) * a.width + x)) continue;
      const float* p = a.pixel(x, y);
      const float* q = b.pixel(x, y);
      for (int c = 0; c < a.channels; ++c) {
        const double d = double(p[c]) - q[c];
        error.sum += d * d;
      }
      error.count += a.channels;
    }
  }
  return error;
}

double to_psnr(const SquaredError& error) {
  if (error.count == 0) return kUndefined;
  return -10 * std::log10(std::max(error.sum / static_cast<double>(error.count), kMinMse));
}

std::array<double, kWindow> gaussian_window() {
  std::array<double, kWindow> w{};
  double sum = 0;
  for (int i = 0; i < kWindow; ++i) {
    const double d = i - kRadius;
    sum += w[i] = std::exp(-d * d / (2 * kSigma * kSigma));
  }
  for (double& v : w) v /= sum;
  return w;
}

/// The five local moments of a pair of rows of values, blurred along x with zero padding.
struct Moments {
  std::vector<float> a, b, aa, bb, ab;
  explicit Moments(size_t n) : a(n), b(n), aa(n), bb(n), ab(n) {}
};

void blur_row(const float* p, const float* q, int width, const std::array<double, kWindow>& w, size_t offset,
              Moments& out) {
  for (int x = 0; x < width; ++x) {
    double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    for (int k = std::max(0, kRadius - x); k < std::min(kWindow, width + kRadius - x); ++k) {
      const double u = p[x + k - kRadius], v = q[x + k - kRadius];
      a += w[k] * u;
      b += w[k] * v;
      aa += w[k] * u * u;
      bb += w[k] * v * v;
      ab += w[k] * u * v;
    }
    out.a[offset + x] = static_cast<float>(a);
    out.b[offset + x] = static_cast<float>(b);
    out.aa[offset + x] = static_cast<float>(aa);
    out.bb[offset + x] = static_cast<float>(bb);
    out.ab[offset + x] = static_cast<float>(ab);
  }
}

/// SSIM of one pixel from the row-blurred moments, summed along y here.
double ssim_at(const Moments& rows, int x, int y, int width, int height, const std::array<double, kWindow>& w) {
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  for (int k = std::max(0, kRadius - y); k < std::min(kWindow, height + kRadius - y); ++k) {
    const size_t i = size_t(y + k - kRadius) * width + x;
    a += w[k] * rows.a[i];
    b += w[k] * rows.b[i];
    aa += w[k] * rows.aa[i];
    bb += w[k] * rows.bb[i];
    ab += w[k] * rows.ab[i];
  }
  const double variance_a = aa - a * a, variance_b = bb - b * b, covariance = ab - a * b;
  return (2 * a * b + kC1) * (2 * covariance + kC2) / ((a * a + b * b + kC1) * (variance_a + variance_b + kC2));
}

void for_rows(ThreadPool* pool, int height, const std::function<void(int)>& row) {
  if (!pool) {
    for (int y = 0; y < height; ++y) row(y);
    return;
  }
  pool->parallel_for(height, 8, [&](size_t begin, size_t end, int) {
    for (size_t y = begin; y < end; ++y) row(static_cast<int>(y));
  });
}

}  // namespace

ImageF displayed(const ImageF& render, const ImageMetricOptions& options) {
  ImageF out = render;
  for (float& v : out.data) {
    v = v > 0 ? std::min(v, 1.0f) : 0.0f;  // NaN compares false and becomes 0
    if (options.quantise) v = std::round(v * 255.0f) / 255.0f;
  }
  return out;
}

double psnr(const ImageF& render, const ImageF& truth, const ImageF& mask, const ImageMetricOptions& options) {
  require_same_size(render, truth, mask);
  return to_psnr(squared_error(displayed(render, options), truth, mask, 0, truth.width));
}

double ssim(const ImageF& render, const ImageF& truth, const ImageF& mask, const ImageMetricOptions& options,
            ThreadPool* pool) {
  require_same_size(render, truth, mask);
  const ImageF shown = displayed(render, options);
  const int width = truth.width, height = truth.height;
  const auto window = gaussian_window();
  double sum = 0;
  size_t count = 0;
  std::vector<float> p(truth.pixels()), q(truth.pixels());
  std::vector<double> row_sums(height);
  Moments rows(truth.pixels());
  for (int c = 0; c < truth.channels; ++c) {
    for (size_t i = 0; i < p.size(); ++i) {
      const bool inside = counts(mask, i);
      p[i] = inside ? shown.data[i * truth.channels + c] : 0.0f;
      q[i] = inside ? truth.data[i * truth.channels + c] : 0.0f;
      count += inside;
    }
    for_rows(pool, height, [&](int y) {
      const size_t offset = size_t(y) * width;
      blur_row(&p[offset], &q[offset], width, window, offset, rows);
    });
    for_rows(pool, height, [&](int y) {
      row_sums[y] = 0;
      for (int x = 0; x < width; ++x) {
        if (counts(mask, size_t(y) * width + x)) row_sums[y] += ssim_at(rows, x, y, width, height, window);
      }
    });
    for (const double s : row_sums) sum += s;  // row by row: the same sum for any number of threads
  }
  return count ? sum / static_cast<double>(count) : kUndefined;
}

ColorAffine fit_color_affine(const ImageF& render, const ImageF& truth, const ImageF& mask, int begin_x, int end_x) {
  require_same_size(render, truth, mask);
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> right = Eigen::Matrix<double, 4, 3>::Zero();
  double pixels = 0;
  for (int y = 0; y < render.height; ++y) {
    for (int x = begin_x; x < end_x; ++x) {
      if (!counts(mask, size_t(y) * render.width + x)) continue;
      const float* p = render.pixel(x, y);
      const float* q = truth.pixel(x, y);
      const Eigen::Vector4d v(p[0], p[1], p[2], 1);
      normal += v * v.transpose();
      right += v * Eigen::RowVector3d(q[0], q[1], q[2]);
      ++pixels;
    }
  }
  const double weight = kIdentityWeight * std::max(pixels, 1.0);
  normal += weight * Eigen::Matrix4d::Identity();
  right.topRows<3>() += weight * Eigen::Matrix3d::Identity();
  const Eigen::Matrix<double, 4, 3> solution = normal.ldlt().solve(right);
  ColorAffine affine;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) affine.m[row][column] = solution(column, row);
  return affine;
}

ImageF apply_color_affine(const ImageF& image, const ColorAffine& affine) {
  ImageF out = image;
  for (size_t i = 0; i < image.pixels(); ++i) {
    const float* p = &image.data[3 * i];
    for (int c = 0; c < 3; ++c) {
      const double* m = affine.m[c];
      out.data[3 * i + c] = static_cast<float>(m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3]);
    }
  }
  return out;
}

ImageScores compare_images(const ImageF& render, const ImageF& truth, const ImageF& mask,
                           const ImageMetricOptions& options, ThreadPool* pool) {
  require_same_size(render, truth, mask);
  if (truth.channels != 3) {
    throw_bad_input({}, "image channels", fmt::format("colour metrics need 3 channels, not {}", truth.channels));
  }
  const ImageF shown = displayed(render, options);
  const int width = truth.width, middle = width / 2;
  ImageScores scores;
  const SquaredError plain = squared_error(shown, truth, mask, 0, width);
  scores.psnr = to_psnr(plain);
  scores.pixels = plain.count / 3;
  scores.ssim = ssim(render, truth, mask, options, pool);

  const auto corrected = [&](int begin_x, int end_x) {
    return displayed(apply_color_affine(shown, fit_color_affine(shown, truth, mask, begin_x, end_x)), options);
  };
  scores.psnr_affine_full = to_psnr(squared_error(corrected(0, width), truth, mask, 0, width));
  const SquaredError right = squared_error(corrected(0, middle), truth, mask, middle, width);
  const SquaredError left = squared_error(corrected(middle, width), truth, mask, 0, middle);
  scores.psnr_affine_crossfit = to_psnr({left.sum + right.sum, left.count + right.count});
  return scores;
}

}  // namespace aligngs
