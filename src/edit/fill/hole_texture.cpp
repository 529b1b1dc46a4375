#include "edit/fill/hole_texture.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "edit/fill/grain_map.h"
#include "edit/fill/pattern_lattice.h"
#include "edit/fill/quilted_texture.h"
#include "edit/fill/repeated_texture.h"
#include "edit/fill/texture_map.h"

namespace aligngs {
namespace {

constexpr float kFaintContrast = 0.05f;  // of the harmonic: noise of an even surface
constexpr float kStrongContrast = 0.5f;  // of the harmonic: flowers of a wallpaper
constexpr float kUnguided = 0.5f;        // of pieces without a pattern, which are like the surface but not it
constexpr float kGuidedByGrain = 0.7f;   // of pieces in phase whose shades are not those of the hidden boards
constexpr double kLight = 0.12;          // / extent: light varies over longer ways, texture over shorter ones (36 cm)
constexpr double kPiece = 0.12;          // / extent: edge of a piece of texture (36 cm)
constexpr double kTextureReach = 0.6;    // / extent: the longest shift of a pattern on itself (1.8 m)
constexpr double kGrainReach = 0.027;    // / extent: half a board (8 cm)
constexpr double kLatticeReach = 0.43;   // / extent: after longer shifts too little lies on itself (1.3 m)
constexpr double kShortestGrain = 2.5;   // of kGrainReach: shorter shifts resemble because of its blur

/// Root of the mean square of the values at some cells.
float length_of(const std::vector<Vec3f>& values, const std::vector<float>& cells) {
  double sum = 0, count = 0;
  for (size_t at = 0; at < values.size(); ++at) {
    sum += static_cast<double>(cells[at] * dot(values[at], values[at]));
    count += static_cast<double>(cells[at]);
  }
  return count > 0 ? static_cast<float>(std::sqrt(sum / count)) : 0;
}

/// The strokes of a hole, where the directions of those around repeat; empty elsewhere.
/// `extent` is in cells.
std::optional<QuiltGuide> grain_guide(const TextureMap& map, double extent) {
  const double half_board = kGrainReach * extent;
  const TextureMap grain = grain_map(map, half_board);
  LatticeSettings settings;
  settings.reach = static_cast<int>(kLatticeReach * extent);
  settings.shortest = kShortestGrain * half_board;
  const std::optional<PatternLattice> lattice = pattern_lattice(grain, settings);
  if (!lattice) return std::nullopt;
  QuiltGuide guide{grain.value, mean_of_copies(grain, *lattice), false};
  // Both are as long as the texture: the guide then counts as it does for colours.
  const float length = length_of(map.value, map.mask), seen = length_of(guide.looks, map.mask),
              predicted = length_of(guide.wanted, map.mask);
  for (Vec3f& v : guide.looks) v *= length / seen;
  for (Vec3f& v : guide.wanted) v *= length / predicted;
  return guide;
}

/// Textures of new Gaussians that look like `texture` when they are drawn: each covers a part of its neighbours. It is
/// Van Cittert's iteration (1931) with the mean that a renderer takes.
std::vector<Vec3f> sharpened(const PlaneGrid& grid, const std::vector<uint8_t>& hole,
                             const std::vector<Vec3f>& texture) {
  constexpr int kRounds = 2, kReach = 2;  // cells
  float weights[kReach + 1];
  for (int d = 0; d <= kReach; ++d)
    weights[d] = std::exp(-0.5f * static_cast<float>(d * d) / (kNewDeviation * kNewDeviation));
  std::vector<Vec3f> out = texture;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<Vec3f> before = out;
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        const size_t at = grid.index(i, j);
        if (!hole[at]) continue;
        Vec3f sum;
        float total = 0;
        for (int y = std::max(0, j - kReach); y <= std::min(grid.rows - 1, j + kReach); ++y) {
          for (int x = std::max(0, i - kReach); x <= std::min(grid.columns - 1, i + kReach); ++x) {
            const size_t other = grid.index(x, y);
            if (!hole[other]) continue;
            const float weight = weights[std::abs(x - i)] * weights[std::abs(y - j)];
            sum += before[other] * weight;
            total += weight;
          }
        }
        out[at] += texture[at] - sum * (1 / total);
      }
    }
  }
  return out;
}

}  // namespace

std::vector<Vec3f> hole_texture(const PlaneGrid& grid, const std::vector<uint8_t>& hole,
                                const std::vector<KnownColor>& known, const HoleTextureSettings& settings) {
  const double extent = settings.extent;
  TextureMapSettings map_settings;
  map_settings.light = kLight * extent;
  const TextureMap map = texture_map(grid, known, map_settings);
  if (contrast_of(map) < kFaintContrast) return {};
  TextureSettings pattern;
  pattern.reach = static_cast<int>(kTextureReach * extent / grid.cell);
  std::vector<Vec3f> texture = repeated_texture(map, pattern);
  std::optional<QuiltGuide> guide;
  if (!texture.empty())
    guide = QuiltGuide{{}, texture, true};
  else if (settings.is_floor)
    guide = grain_guide(map, extent / grid.cell);
  // Without a pattern that guides them, pieces of a faint texture are blotches: an even surface looks calmer.
  if (!guide && contrast_of(map) < kStrongContrast) return {};
  QuiltSettings quilt;
  quilt.piece = std::max(8, static_cast<int>(kPiece * extent / grid.cell));
  quilt.overlap = quilt.piece / 3;
  const std::vector<Vec3f> pieces = quilted_texture(map, hole, guide ? &*guide : nullptr, quilt);
  if (pieces.empty()) return texture;
  texture.resize(grid.size());
  const float share = !guide ? kUnguided : guide->is_exact ? 1 : kGuidedByGrain;
  for (size_t at = 0; at < texture.size(); ++at) {
    if (hole[at]) texture[at] = pieces[at] * share;
  }
  return guide ? sharpened(grid, hole, texture) : texture;
}

}  // namespace aligngs
