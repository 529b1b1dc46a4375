// How close a rendered picture is to the photo: PSNR and SSIM, plain and after a colour fit.
#pragma once

#include <cstddef>

#include "core/image.h"
#include "core/thread_pool.h"

namespace aligngs {

/// PSNR of two equal images would be infinite; it is reported as this many dB instead.
inline constexpr double kMaxPsnr = 100;

struct ImageMetricOptions {
  /// Clamp the render to [0, 1] and round it to 8 bits first, as if written to PNG. The field measures written files
  /// (3DGS, AlignGS). Without it the render is only clamped.
  bool quantise = true;
};

/// The numbers of one test view. A number is NaN when no pixel counts (JSON shows null).
struct ImageScores {
  double psnr = 0;                  ///< dB, over all channels of all pixels
  double ssim = 0;                  ///< see ssim()
  double psnr_affine_crossfit = 0;  ///< dB, 3x4 colour fit on one half, scored on the other
  double psnr_affine_full = 0;      ///< dB, fitted and scored on all pixels: an optimistic diagnostic
  size_t pixels = 0;                ///< pixels that counted
};

/// Clamped to [0, 1], rounded to multiples of 1/255 when asked; NaN becomes 0.
ImageF displayed(const ImageF& render, const ImageMetricOptions& options = {});

/// 10 log10(1 / MSE), at most kMaxPsnr, over pixels with mask >= 0.5 (all when the mask is empty).
/// Images are H x W x C in [0, 1]; different sizes: Error{kBadInput}.
double psnr(const ImageF& render, const ImageF& truth, const ImageF& mask = {}, const ImageMetricOptions& options = {});

/// Structural similarity (Wang et al. 2004): 11x11 Gaussian window of sigma 1.5, C1 = 0.01^2, C2 = 0.03^2, zero
/// padding. Each channel is on its own, mean over everything, as in 3DGS and its successors. With a mask, both images
/// are zero outside it and the mean runs over the pixels inside.
double ssim(const ImageF& render, const ImageF& truth, const ImageF& mask = {}, const ImageMetricOptions& options = {},
            ThreadPool* pool = nullptr);

/// out = A (r, g, b, 1): absorbs exposure and white balance of a photo.
struct ColorAffine {
  double m[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
};

/// The least-squares affine that takes `render` to `truth` over columns [begin_x, end_x) and mask >= 0.5. A pull to
/// the identity, far weaker than any photo's noise, keeps it defined for one-colour images.
ColorAffine fit_color_affine(const ImageF& render, const ImageF& truth, const ImageF& mask, int begin_x, int end_x);
ImageF apply_color_affine(const ImageF& image, const ColorAffine& affine);

/// All of the above. Three-channel images only (Error{kBadInput} otherwise).
ImageScores compare_images(const ImageF& render, const ImageF& truth, const ImageF& mask = {},
                           const ImageMetricOptions& options = {}, ThreadPool* pool = nullptr);

}  // namespace aligngs
