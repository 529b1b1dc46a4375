// Rays of pixel centres.
#pragma once

#include "core/vec.h"
#include "scene/camera.h"

namespace aligngs {

/// Camera::ray of pixel centres in T, without a division per pixel.
template <class T>
struct PixelRays {
  T step_x{}, step_y{}, first_x{}, first_y{};
  PixelRays() = default;
  explicit PixelRays(const Camera& camera)
      : step_x(static_cast<T>(1 / camera.fx)),
        step_y(static_cast<T>(1 / camera.fy)),
        first_x(static_cast<T>(0.5 - camera.cx)),
        first_y(static_cast<T>(0.5 - camera.cy)) {}
  ALIGNGS_HD Vec3<T> operator()(int x, int y) const {
    return {(static_cast<T>(x) + first_x) * step_x, (static_cast<T>(y) + first_y) * step_y, T(1)};
  }
};

}  // namespace aligngs
