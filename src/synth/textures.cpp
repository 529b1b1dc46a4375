#include "synth/textures.h"

#include <algorithm>
#include <cmath>

#include "core/srgb.h"
#include "synth/noise.h"
#include "synth/pictures.h"
#include "synth/texture_math.h"

namespace aligngs {
namespace {

float smooth_step(float low, float high, float x) {
  const float t = clamp01((x - low) / (high - low));
  return t * t * (3 - 2 * t);
}

/// 1 while detail of the given size (metres) is resolved by samples of size `footprint`, 0 when it is not.
float resolved(float size, float footprint) { return 1 - smooth_step(0.35f, 1.0f, footprint / size); }

/// 1 within `half_width` of the nearest integer, 0 elsewhere.
float line(float x, float half_width) {
  const float d = std::fabs(x - std::round(x));
  return 1 - smooth_step(half_width * 0.7f, half_width * 1.3f, d);
}

Vec3f wood(const Material& m, float u, float v, float footprint, uint32_t seed) {
  const float s = 1 / m.scale;
  const float wobble = fractal_noise(u * 2.2f * s, v * 9 * s, 3, seed);
  const float rings = 0.5f + 0.5f * std::sin((v * 85 * s + wobble * 5.0f) * 2);
  const float fibre = value_noise(u * 18 * s, v * 420 * s, seed + 7) * resolved(0.004f * m.scale, footprint);
  const float cloud = fractal_noise(u * 1.3f * s, v * 3 * s, 2, seed + 3);
  const float t = clamp01(0.55f * rings * resolved(0.03f * m.scale, footprint) + 0.22f * fibre + 0.35f * cloud + 0.15f);
  return mix(m.a, m.b, t);
}

Vec3f planks(const Material& m, float u, float v, float footprint) {
  const float width = 0.13f * m.scale, length = 1.1f * m.scale;
  const float row = std::floor(v / width);
  const float shift = lattice_random(static_cast<int>(row), 5, 0, m.seed) * length;
  const float column = std::floor((u + shift) / length);
  const uint32_t board = lattice_hash(static_cast<int>(row), static_cast<int>(column), 1, m.seed);
  Vec3f color = wood(m, u + static_cast<float>(board % 97), v + static_cast<float>(board % 31), footprint, board);
  color *= 0.78f + 0.44f * static_cast<float>(board >> 8 & 255) / 255;
  const float gap = std::max(line(v / width, 0.012f / m.scale), line((u + shift) / length, 0.0016f / m.scale));
  return mix(color, m.a * 0.18f, 0.8f * gap * resolved(0.012f, footprint * 0.5f));
}

Vec3f parquet(const Material& m, float u, float v, float footprint) {
  const float side = 0.42f * m.scale;
  const int i = static_cast<int>(std::floor(u / side)), j = static_cast<int>(std::floor(v / side));
  const bool turned = ((i + j) & 1) != 0;
  const float along = turned ? v : u, across = turned ? u : v;
  const int stave = static_cast<int>(std::floor(across / (side / 5)));
  const uint32_t board = lattice_hash(i, j, stave, m.seed);
  Vec3f color =
      wood(m, along + static_cast<float>(board % 53), across + static_cast<float>(board % 17), footprint, board);
  color *= 0.72f + 0.5f * static_cast<float>(board >> 8 & 255) / 255;
  const float gap = std::max({line(across / (side / 5), 0.02f), line(u / side, 0.006f), line(v / side, 0.006f)});
  return mix(color, m.a * 0.2f, 0.7f * gap * resolved(0.01f, footprint * 0.5f));
}

Vec3f weave(const Material& m, float u, float v, float footprint) {
  const float pitch = 0.011f * m.scale;
  const float detail = resolved(pitch, footprint);
  const float x = u / pitch, y = v / pitch;
  const bool over = ((static_cast<int>(std::floor(x)) + static_cast<int>(std::floor(y))) & 1) != 0;
  const float thread = over ? std::sin(kPiFloat * fraction(x)) : std::sin(kPiFloat * fraction(y));
  const float slub = fractal_noise(u * 14 / m.scale, v * 14 / m.scale, 3, m.seed);
  const float blotch = fractal_noise(u * 3, v * 3, 2, m.seed + 9);
  const Vec3f base = mix(m.a, m.b, clamp01(0.4f + 0.6f * slub * resolved(0.07f * m.scale, footprint) + 0.2f * blotch));
  return base * (1 - 0.35f * detail * (1 - thread));
}

Vec3f stripes(const Material& m, float u, float v, float footprint) {
  const float period = 0.12f * m.scale;
  const float x = fraction(u / period);
  const Vec3f color = x < 0.42f ? m.a : (x < 0.5f ? m.c : (x < 0.92f ? m.b : m.c));
  const float thread = value_noise(u * 260, v * 60, m.seed) * resolved(0.01f, footprint);
  return color * (0.94f + 0.12f * thread + 0.1f * fractal_noise(u * 6, v * 6, 2, m.seed));
}

Vec3f checks(const Material& m, float u, float v, float footprint) {
  const float period = 0.1f * m.scale;
  const bool first = fraction(u / period) < 0.5f, second = fraction(v / period) < 0.5f;
  Vec3f color = first && second ? m.a : (first || second ? mix(m.a, m.b, 0.55f) : m.b);
  color = mix(color, m.c, 0.7f * std::max(line(u / period + 0.25f, 0.05f), line(v / period + 0.25f, 0.05f)));
  return color * (0.95f + 0.1f * value_noise(u * 200, v * 200, m.seed) * resolved(0.01f, footprint) +
                  0.08f * fractal_noise(u * 7, v * 7, 2, m.seed));
}

/// Blossoms scattered one per cell, each of its own size, turn and colour.
Vec3f floral(const Material& m, float u, float v, float footprint, int petals, float cell) {
  Vec3f color = m.a * (0.97f + 0.06f * fractal_noise(u * 9, v * 9, 2, m.seed));
  const int ci = static_cast<int>(std::floor(u / cell)), cj = static_cast<int>(std::floor(v / cell));
  for (int j = cj - 1; j <= cj + 1; ++j) {
    for (int i = ci - 1; i <= ci + 1; ++i) {
      const float px = (static_cast<float>(i) + 0.2f + 0.6f * lattice_random(i, j, 1, m.seed)) * cell;
      const float py = (static_cast<float>(j) + 0.2f + 0.6f * lattice_random(i, j, 2, m.seed)) * cell;
      const float radius = cell * (0.25f + 0.3f * lattice_random(i, j, 3, m.seed));
      const float dx = u - px, dy = v - py, d = std::sqrt(dx * dx + dy * dy);
      if (d > radius) continue;
      const float angle = std::atan2(dy, dx) + 6.28f * lattice_random(i, j, 4, m.seed);
      const float edge = radius * (0.62f + 0.38f * std::cos(static_cast<float>(petals) * angle));
      const float inside = 1 - smooth_step(edge - std::max(0.004f, footprint), edge + std::max(0.004f, footprint), d);
      const Vec3f petal = mix(m.b, m.c, lattice_random(i, j, 5, m.seed)) * (0.7f + 0.5f * d / radius);
      color = mix(color, petal, inside);
      color = mix(color, m.c * 0.6f, 1 - smooth_step(0.13f * radius, 0.2f * radius, d));
    }
  }
  return color;
}

/// An oriental carpet over the unit square: nested borders, a field with medallions, tufts.
Vec3f carpet(const Material& m, float u, float v, float footprint) {
  const float edge = std::min(std::min(u, 1 - u), std::min(v, 1 - v) * 0.7f);
  const float size = m.scale;  // metres of the longer side
  const float x = u * 16, y = v * 11;
  const float diamond = std::fabs(fraction(x) - 0.5f) + std::fabs(fraction(y) - 0.5f);
  const uint32_t cell = lattice_hash(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)), 0, m.seed);
  Vec3f color;
  if (edge < 0.015f)
    color = m.b * 0.8f;
  else if (edge < 0.05f)
    color = fraction((u + v) * 24) < 0.5f ? m.b : m.c;
  else if (edge < 0.06f)
    color = m.c * 0.5f;
  else if (edge < 0.12f)
    color = diamond < 0.3f ? m.c : (diamond < 0.38f ? m.a * 0.4f : m.b);
  else if (edge < 0.13f)
    color = m.c * 0.5f;
  else {
    const float r = std::hypot((u - 0.5f) * 2.2f, (v - 0.5f) * 2.6f);
    const float a = std::atan2(v - 0.5f, u - 0.5f);
    const float medallion = r + 0.06f * std::cos(8 * a);
    if (medallion < 0.2f)
      color = diamond < 0.35f ? m.a : m.c;
    else if (medallion < 0.24f)
      color = m.b * 0.5f;
    else if (medallion < 0.48f)
      color = (cell & 3u) == 0 && diamond < 0.4f ? m.a : m.b;
    else if (medallion < 0.52f)
      color = m.c;
    else
      color = diamond < 0.25f ? ((cell & 1u) != 0 ? m.b : m.c) : m.a;
  }
  const float tuft = value_noise(u * size * 130, v * size * 130, m.seed) * resolved(0.015f, footprint);
  return color * (0.88f + 0.2f * tuft + 0.25f * fractal_noise(u * 20, v * 20, 2, m.seed + 2));
}

Vec3f brick(const Material& m, float u, float v, float footprint) {
  const float length = 0.24f * m.scale, height = 0.075f * m.scale;
  const int row = static_cast<int>(std::floor(v / height));
  const float x = u / length + ((row & 1) != 0 ? 0.5f : 0.0f);
  const uint32_t id = lattice_hash(static_cast<int>(std::floor(x)), row, 0, m.seed);
  const float tint = 0.65f + 0.6f * static_cast<float>(id & 255u) / 255;
  const Vec3f stone = mix(m.a, m.b, static_cast<float>(id >> 8 & 255u) / 255) *
                      (tint + 0.35f * fractal_noise(u * 30, v * 30, 3, m.seed) * resolved(0.03f, footprint));
  const float joint = std::max(line(x, 0.025f), line(v / height, 0.075f));
  return mix(stone, m.c, joint);
}

Vec3f tiles(const Material& m, float u, float v, float footprint) {
  const float side = 0.3f * m.scale;
  const int i = static_cast<int>(std::floor(u / side)), j = static_cast<int>(std::floor(v / side));
  const uint32_t id = lattice_hash(i, j, 0, m.seed);
  const float vein = fractal_noise(u * 5 / m.scale + static_cast<float>(id % 19), v * 5 / m.scale, 4, m.seed);
  Vec3f color = mix(m.a, m.b, clamp01(0.3f + 0.9f * vein + 0.35f * static_cast<float>(id & 255u) / 255));
  color = mix(color, m.b * 0.7f, 0.5f * line(vein * 4, 0.05f) * resolved(0.02f, footprint));
  const float grout = std::max(line(u / side, 0.011f / m.scale), line(v / side, 0.011f / m.scale));
  return mix(color, m.c, grout * resolved(0.012f, footprint * 0.5f));
}

Vec3f stone(const Material& m, float u, float v, float footprint) {
  const float s = 1 / m.scale;
  const float speck = value_noise(u * 150 * s, v * 150 * s, m.seed) * resolved(0.012f * m.scale, footprint);
  const float cloud = fractal_noise(u * 11 * s, v * 11 * s, 4, m.seed + 5);
  Vec3f color = mix(m.a, m.b, clamp01(0.45f + 0.8f * cloud));
  return mix(color, m.c, 0.7f * smooth_step(0.35f, 0.75f, speck));
}

Vec3f wall_stripes(const Material& m, float u, float v, float footprint) {
  const float period = 0.22f * m.scale, x = fraction(u / period);
  Vec3f color = x < 0.5f ? m.a : m.b;
  color = mix(color, m.c, std::max(line(u / period, 0.02f), line(u / period + 0.5f, 0.02f)));
  const float dots = x < 0.5f ? std::hypot(fraction(u / period * 4) - 0.5f, fraction(v / 0.055f) - 0.5f) : 1.0f;
  color = mix(color, m.c, 0.5f * (1 - smooth_step(0.14f, 0.22f, dots)) * resolved(0.05f, footprint));
  return color * (0.97f + 0.07f * fractal_noise(u * 8, v * 3, 2, m.seed));
}

Vec3f damask(const Material& m, float u, float v, float footprint) {
  const float cell = 0.3f * m.scale;
  const int row = static_cast<int>(std::floor(v / cell));
  const float x = fraction(u / cell + ((row & 1) != 0 ? 0.5f : 0.0f)) - 0.5f, y = fraction(v / cell) - 0.5f;
  const float r = std::hypot(x * 1.25f, y), a = std::atan2(y, std::fabs(x));
  const float outer = 0.36f + 0.08f * std::cos(6 * a), inner = 0.2f + 0.06f * std::cos(10 * a + 1);
  const float soft = std::max(0.012f, footprint / cell);
  float ornament = (1 - smooth_step(outer - soft, outer + soft, r)) * smooth_step(inner - soft, inner + soft, r);
  ornament = std::max(ornament, 1 - smooth_step(0.1f - soft, 0.1f + soft, r + 0.03f * std::cos(5 * a)));
  const Vec3f ground = m.a * (0.96f + 0.1f * fractal_noise(u * 40, v * 40, 2, m.seed) * resolved(0.02f, footprint));
  return mix(ground, mix(m.b, m.c, clamp01(0.5f + y)), ornament);
}

Vec3f shag(const Material& m, float u, float v, float footprint) {
  const float tuft =
      fractal_noise(u * 55 / m.scale, v * 55 / m.scale, 3, m.seed) * resolved(0.02f * m.scale, footprint);
  const float cloud = fractal_noise(u * 5, v * 5, 3, m.seed + 4);
  return mix(m.a, m.b, clamp01(0.45f + 1.1f * tuft + 0.7f * cloud));
}

Vec3f book_side(const Material& m, float u, float v) {
  // u across the back, v up, metres; bands and a title block whose place depends on the seed.
  const float height = 0.18f + 0.1f * lattice_random(1, 0, 0, m.seed);
  const float y = v / height;
  Vec3f color = m.a * (0.93f + 0.14f * value_noise(u * 90, v * 90, m.seed));
  const float low = 0.08f + 0.1f * lattice_random(2, 0, 0, m.seed),
              high = 0.82f + 0.1f * lattice_random(3, 0, 0, m.seed);
  if (std::fabs(y - low) < 0.02f || std::fabs(y - high) < 0.02f) color = m.b;
  const float title_low = 0.35f + 0.15f * lattice_random(4, 0, 0, m.seed);
  if (y > title_low && y < title_low + 0.28f && lattice_random(static_cast<int>(y * 26), 7, 0, m.seed) > 0.35f) {
    color = mix(color, m.b, 0.85f);
  }
  return color;
}

Vec3f leaf(const Material& m, float u, float v) {
  const float rib = line(v / 0.5f, 0.012f), veins = line((u + 1.3f * std::fabs(v)) / 0.05f, 0.07f);
  const Vec3f color = mix(m.a, m.b, clamp01(0.4f + 0.9f * fractal_noise(u * 14, v * 14, 3, m.seed)));
  return mix(color, m.b * 1.25f, std::max(0.8f * rib, 0.35f * veins));
}

Vec3f wicker(const Material& m, float u, float v, float footprint) {
  const float x = u / 0.035f, y = v / 0.018f;
  const bool over = ((static_cast<int>(std::floor(x)) + static_cast<int>(std::floor(y))) & 1) != 0;
  const float bulge = std::sin(kPiFloat * fraction(y)) * (over ? std::sin(kPiFloat * fraction(x)) : 0.55f);
  const float tint = 0.3f * value_noise(u * 40, v * 40, m.seed);
  return mix(m.b, m.a, clamp01(0.2f + bulge * resolved(0.018f, footprint * 0.6f) + tint));
}

}  // namespace

Vec3f texture_color(const Material& m, const Vec2f& uv, float footprint) {
  const float u = uv.x, v = uv.y;
  switch (m.kind) {
    case TextureKind::kPlain:
      return m.a;
    case TextureKind::kWood:
      return wood(m, u, v, footprint, m.seed);
    case TextureKind::kPlanks:
      return planks(m, u, v, footprint);
    case TextureKind::kParquet:
      return parquet(m, u, v, footprint);
    case TextureKind::kWeave:
      return weave(m, u, v, footprint);
    case TextureKind::kStripes:
      return stripes(m, u, v, footprint);
    case TextureKind::kChecks:
      return checks(m, u, v, footprint);
    case TextureKind::kFloral:
      return floral(m, u, v, footprint, 5, 0.13f * m.scale);
    case TextureKind::kCarpet:
      return carpet(m, u, v, footprint);
    case TextureKind::kShag:
      return shag(m, u, v, footprint);
    case TextureKind::kBrick:
      return brick(m, u, v, footprint);
    case TextureKind::kTiles:
      return tiles(m, u, v, footprint);
    case TextureKind::kStone:
      return stone(m, u, v, footprint);
    case TextureKind::kWallStripes:
      return wall_stripes(m, u, v, footprint);
    case TextureKind::kWallDamask:
      return damask(m, u, v, footprint);
    case TextureKind::kWallLeaves:
      return floral(m, u, v, footprint, 2, 0.2f * m.scale);
    case TextureKind::kPainting:
      return painting_color(m, u, v);
    case TextureKind::kBooks:
      return book_side(m, u, v);
    case TextureKind::kLeaf:
      return leaf(m, u, v);
    case TextureKind::kOutside:
      return garden_color(m, u, v);
    case TextureKind::kScreen:
      return screen_color(m, u, v);
    case TextureKind::kKeys:
      return keyboard_color(m, u, v);
    case TextureKind::kWicker:
      return wicker(m, u, v, footprint);
  }
  return m.a;
}

Vec3f linear_rgb(int r, int g, int b) {
  return {srgb_decode(static_cast<float>(r) / 255), srgb_decode(static_cast<float>(g) / 255),
          srgb_decode(static_cast<float>(b) / 255)};
}

}  // namespace aligngs
