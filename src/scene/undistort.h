// Resampling of images and maps through a lens to a pinhole camera.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/image.h"
#include "scene/lens_model.h"

namespace aligngs {

/// A pinhole of the lens's size and principal point whose every pixel has a source in the distorted image. It has the
/// smallest such scale of the focal lengths within [0.5, 2]. Error{kBadInput} naming `path` when the distortion folds
/// over (not invertible in the image) at any of these scales.
Camera undistorted_camera(const LensModel& lens, const std::filesystem::path& path);

/// Resamples to `pinhole` (pose ignored). The map's size may differ from the lens's: both cameras are scaled to it. The
/// result has the aspect of `pinhole` with the map's width. Outside of the source: 0.
ImageF undistort_image(const ImageF& image, const LensModel& lens, const Camera& pinhole);  ///< bilinear, any channels
/// Depth along the z axis is unchanged by undistortion. Bilinear where the four samples are valid and within
/// `jump` relative of each other, else the nearest one: no flying pixels.
ImageF undistort_depth(const ImageF& depth, const LensModel& lens, const Camera& pinhole, float jump = 0.05f);
/// Nearest sample; `none` outside of the source.
Image<uint16_t> undistort_labels(const Image<uint16_t>& labels, const LensModel& lens, const Camera& pinhole,
                                 uint16_t none);

}  // namespace aligngs
