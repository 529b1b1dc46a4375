// Procedural surface colour: wood, cloth, carpet, tiles, wallpaper, paintings, book spines, ...
#pragma once

#include <cstdint>

#include "core/vec.h"

namespace aligngs {

enum class TextureKind : uint8_t {
  kPlain,        ///< one colour: bare paint, plastic, metal
  kWood,         ///< grain along u
  kPlanks,       ///< floor boards along u
  kParquet,      ///< herringbone-like blocks
  kWeave,        ///< coarse cloth
  kStripes,      ///< striped cloth along v
  kChecks,       ///< checked cloth
  kFloral,       ///< blossoms on a plain ground
  kCarpet,       ///< pile with a border pattern of medallions
  kShag,         ///< pile of one colour
  kBrick,        ///< brickwork, v is up
  kTiles,        ///< glazed tiles with grout
  kStone,        ///< speckled stone
  kWallStripes,  ///< wallpaper with vertical stripes
  kWallDamask,   ///< wallpaper with ornaments
  kWallLeaves,   ///< wallpaper with leaves
  kPainting,     ///< abstract picture in the unit square
  kBooks,        ///< the visible side of a book: title bands
  kLeaf,         ///< plant leaf, midrib along u
  kOutside,      ///< blurred garden behind a window, unit square
  kScreen,       ///< a computer screen, unit square
  kKeys,         ///< a keyboard, unit square
  kWicker,       ///< basket work
};

/// Look of a surface. Colours are linear RGB albedo in [0, 1].
struct Material {
  TextureKind kind = TextureKind::kPlain;
  Vec3f a{0.8f, 0.8f, 0.8f}, b, c;  ///< main, second and third colour of the pattern
  float scale = 1;                  ///< size of the pattern: 1 = its natural size in metres
  float gloss = 0;                  ///< 0 matt; 1 polished (mirrors by Fresnel's law)
  float reflectance = 0.04f;        ///< mirrored share at a right angle with gloss 1; 0.04: refractive index 1.5
  float roughness = 0.008f;         ///< largest deviation of a reflected ray, radians: polish that is not a mirror
  int mirror_rays = 1;              ///< reflected rays of a sample
  float emission = 0;               ///< radiance = emission * colour
  uint32_t seed = 0;
  bool see_through = false;       ///< a pane: what is not mirrored is the view outside (outside.h)
  bool unreliable_depth = false;  ///< glass, screens, very dark gloss: depth networks fail here

  /// Near-white paint without texture: the surface photometric learning gets nothing from.
  bool is_bare() const {
    return kind == TextureKind::kPlain && emission == 0 && a.x > 0.5f && a.y > 0.5f && a.z > 0.5f;
  }
};

/// Colour of a material at texture coordinates `uv` (metres). `footprint` is the size of a sample there in metres:
/// detail finer than it is faded out. Distant surfaces hence do not flicker between views.
Vec3f texture_color(const Material& material, const Vec2f& uv, float footprint);

/// Linear RGB of sRGB bytes.
Vec3f linear_rgb(int r, int g, int b);

}  // namespace aligngs
