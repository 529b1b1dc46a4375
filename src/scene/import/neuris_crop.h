// NeuRIS' preparation of ScanNet: the middle 1248/1296 of the width and 936/968 of the height, resized to 640x480.
#pragma once

#include "core/image.h"
#include "scene/camera.h"

namespace aligngs {

Camera neuris_camera(const Camera& camera);
/// Bilinear between pixels.
ImageF neuris_image(const ImageF& image);
/// The nearest pixel, as depth on two sides of an edge has no mean.
ImageF neuris_depth(const ImageF& depth);

}  // namespace aligngs
