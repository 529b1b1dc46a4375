#include "synth/pictures.h"

#include <algorithm>
#include <cmath>

#include "synth/noise.h"
#include "synth/texture_math.h"

namespace aligngs {
namespace {

/// A saturated colour of the seed's palette.
Vec3f palette(uint32_t seed, int index) {
  const float hue = lattice_random(index, 11, 0, seed) * 6;
  const float value = 0.35f + 0.55f * lattice_random(index, 12, 0, seed);
  const float chroma = value * (0.35f + 0.6f * lattice_random(index, 13, 0, seed));
  const float x = chroma * (1 - std::fabs(std::fmod(hue, 2.0f) - 1)), base = value - chroma;
  const int sector = static_cast<int>(hue) % 6;
  const float r[6] = {chroma, x, 0, 0, x, chroma}, g[6] = {x, chroma, chroma, x, 0, 0},
              b[6] = {0, 0, x, chroma, chroma, x};
  return {base + r[sector], base + g[sector], base + b[sector]};
}

/// Rectangles by repeated splitting, separated by dark bars.
Vec3f blocks(uint32_t seed, float u, float v) {
  float x0 = 0, x1 = 1, y0 = 0, y1 = 1;
  int id = 1;
  for (int level = 0; level < 5; ++level) {
    const float cut = 0.3f + 0.4f * lattice_random(id, level, 1, seed);
    if (lattice_random(id, level, 2, seed) < 0.1f && level > 1) break;
    if ((level & 1) == 0) {
      const float c = x0 + cut * (x1 - x0);
      if (std::fabs(u - c) < 0.012f) return {0.02f, 0.02f, 0.02f};
      if (u < c) {
        x1 = c;
        id = id * 2;
      } else {
        x0 = c;
        id = id * 2 + 1;
      }
    } else {
      const float c = y0 + cut * (y1 - y0);
      if (std::fabs(v - c) < 0.012f) return {0.02f, 0.02f, 0.02f};
      if (v < c) {
        y1 = c;
        id = id * 2;
      } else {
        y0 = c;
        id = id * 2 + 1;
      }
    }
  }
  return palette(seed, id % 9);
}

Vec3f landscape(uint32_t seed, float u, float v) {
  Vec3f color = mix(palette(seed, 1), {0.85f, 0.85f, 0.8f}, clamp01(1.3f - v));
  const float sun = std::hypot(u - 0.2f - 0.6f * lattice_random(5, 0, 0, seed), v - 0.78f);
  if (sun < 0.09f) color = {0.95f, 0.75f, 0.35f};
  for (int layer = 0; layer < 5; ++layer) {
    const float ridge =
        0.68f - 0.13f * static_cast<float>(layer) +
        0.16f * fractal_noise(u * (2.0f + static_cast<float>(layer)), static_cast<float>(layer) * 7, 4, seed);
    if (v < ridge) color = palette(seed, 2 + layer) * (0.75f - 0.1f * static_cast<float>(layer));
  }
  return color * (0.9f + 0.25f * fractal_noise(u * 40, v * 12, 2, seed));
}

Vec3f circles(uint32_t seed, float u, float v) {
  Vec3f color = mix({0.82f, 0.78f, 0.68f}, palette(seed, 0), 0.2f);
  for (int i = 0; i < 11; ++i) {
    const float x = lattice_random(i, 1, 0, seed), y = lattice_random(i, 2, 0, seed);
    const float r = 0.07f + 0.2f * lattice_random(i, 3, 0, seed), d = std::hypot(u - x, v - y);
    if (d < r) color = mix(color, palette(seed, i), 0.85f);
    if (d > r * 0.6f && d < r * 0.7f) color = color * 0.35f;
  }
  return color;
}

Vec3f strokes(uint32_t seed, float u, float v) {
  const float wx = fractal_noise(u * 3, v * 3, 3, seed), wy = fractal_noise(u * 3, v * 3, 3, seed + 1);
  const float t = fractal_noise(u * 2 + 1.6f * wx, v * 2 + 1.6f * wy, 4, seed + 2);
  const int band = static_cast<int>(std::floor((t + 1) * 5));
  const float grain = value_noise((u + wx) * 70, (v + wy) * 14, seed);
  return palette(seed, band) * (0.85f + 0.25f * grain);
}

}  // namespace

Vec3f painting_color(const Material& m, float u, float v) {
  // A passe-partout around the picture.
  const float border = 0.07f;
  if (u < border || v < border || u > 1 - border || v > 1 - border) return {0.75f, 0.73f, 0.68f};
  const float x = (u - border) / (1 - 2 * border), y = (v - border) / (1 - 2 * border);
  switch (m.seed % 4) {
    case 0:
      return blocks(m.seed, x, y);
    case 1:
      return landscape(m.seed, x, y);
    case 2:
      return circles(m.seed, x, y);
    default:
      return strokes(m.seed, x, y);
  }
}

Vec3f garden_color(const Material& m, float u, float v) {
  const float treeline = 0.42f + 0.22f * fractal_noise(u * 3, 0.5f, 3, m.seed);
  const float blur = 0.12f;
  const Vec3f sky = mix({0.95f, 0.97f, 1.0f}, {0.62f, 0.78f, 1.0f}, v);
  const float foliage = 0.5f + 0.5f * fractal_noise(u * 6, v * 6, 2, m.seed + 1);
  const Vec3f tree = mix({0.1f, 0.2f, 0.07f}, {0.35f, 0.5f, 0.2f}, foliage);
  const Vec3f lawn =
      mix({0.25f, 0.4f, 0.12f}, {0.45f, 0.6f, 0.25f}, 0.5f + 0.5f * fractal_noise(u * 4, v * 9, 2, m.seed + 2));
  Vec3f color = mix(tree, sky, clamp01((v - treeline) / blur + 0.5f));
  return mix(lawn, color, clamp01((v - 0.2f) / blur + 0.5f));
}

Vec3f screen_color(const Material& m, float u, float v) {
  Vec3f color =
      mix(Vec3f{0.05f, 0.12f, 0.3f}, Vec3f{0.15f, 0.4f, 0.5f}, clamp01(0.5f + fractal_noise(u * 3, v * 3, 3, m.seed)));
  for (int i = 0; i < 3; ++i) {
    const float x = 0.05f + 0.5f * lattice_random(i, 0, 0, m.seed), y = 0.1f + 0.4f * lattice_random(i, 1, 0, m.seed);
    const float w = 0.3f + 0.15f * lattice_random(i, 2, 0, m.seed), h = 0.35f + 0.15f * lattice_random(i, 3, 0, m.seed);
    if (u < x || u > x + w || v < y || v > y + h) continue;
    color = v > y + h - 0.05f ? Vec3f{0.25f, 0.3f, 0.4f} : Vec3f{0.75f, 0.77f, 0.78f};
    const int row = static_cast<int>(v * 34);
    const float length = 0.35f + 0.6f * lattice_random(row, 8, i, m.seed);
    if (v < y + h - 0.06f && fraction(v * 34) < 0.5f && u - x > 0.02f && (u - x) / w < length) {
      color = lattice_random(static_cast<int>(u * 90), row, i, m.seed) < 0.75f ? Vec3f{0.08f, 0.1f, 0.2f} : color;
    }
  }
  if (v < 0.045f) color = {0.03f, 0.03f, 0.05f};
  return color;
}

Vec3f keyboard_color(const Material& m, float u, float v) {
  const float row = v * 5, x = u * 15 + 0.35f * std::floor(row);
  const bool gap = fraction(row) < 0.16f || fraction(x) < 0.16f || u < 0.02f || u > 0.98f;
  if (gap) return m.b;
  const float letter = std::hypot(fraction(x) - 0.5f, fraction(row) - 0.55f);
  return letter < 0.13f && lattice_random(static_cast<int>(x), static_cast<int>(row), 0, m.seed) < 0.8f ? m.c : m.a;
}

}  // namespace aligngs
