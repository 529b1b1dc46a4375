// Whether a Gaussian can reach a box of pixels at all: bounds the work of blending, the alpha test decides.
#pragma once

#include "engine/formulas/projection_camera.h"
#include "engine/formulas/splat.h"

namespace aligngs {

/// False only where no pixel centre of [left, left + width) x [top, top + height) reaches alpha_min.
///
/// The form p^2 + r^2 of splat.h is convex. Over a box without the mean its minimum hence lies on the nearest vertical
/// or horizontal edge.
ALIGNGS_HD inline bool reaches_box(const Splat& g, float left, float top, float width, float height) {
  // Slack for rounding, relative and absolute.
  constexpr float kLevelFactor = 1.001f, kLevelMargin = 1e-3f;
  const float level = g.level * kLevelFactor + kLevelMargin;
  const float x0 = left + 0.5f - g.x, x1 = x0 + (width - 1), y0 = top + 0.5f - g.y, y1 = y0 + (height - 1);
  const float ex = clamp_to(0.0f, x0, x1), ey = clamp_to(0.0f, y0, y1);  // nearest to the mean
  // Minimum of the form on the lines x = ex and y = ey.
  const float vy = clamp_to(-ex * (g.fxx * g.fxy / (g.fxy * g.fxy + g.fyy * g.fyy)), y0, y1);
  const float hx = clamp_to(-ey * (g.fxy / g.fxx), x0, x1);
  const float vp = g.fxx * ex + g.fxy * vy, vr = g.fyy * vy;
  const float hp = g.fxx * hx + g.fxy * ey, hr = g.fyy * ey;
  const float vertical = vp * vp + vr * vr, horizontal = hp * hp + hr * hr;
  return (vertical < horizontal ? vertical : horizontal) <= level;
}

}  // namespace aligngs
