// A textured wall with a sideboard before it and a black screen, drawn in closed form: hanging, standing or standing
// turned.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "refine/panel_depth.h"
#include "refine/testing/wall_photos.h"

namespace aligngs::screen_room {

// x right, y down, z forward, metres; cameras look along +z.
inline constexpr double kWall = 3, kScreenFloor = 1.3;
/// of the sideboard, which reaches from there to wall and floor
inline constexpr double kTop = 0.5, kFront = 2.5;
inline constexpr double kHalfWidth = 0.45, kHigh = -0.1;    ///< of the screen, and its upper edge
inline constexpr double kHanging = 2.95, kStanding = 2.75;  ///< its distance
/// its lower edge: a foot lifts a standing one off the top
inline constexpr double kLowHanging = 0.35, kLowStanding = 0.45;
inline constexpr uint16_t kOtherLabel = 0, kScreenLabel = 1;
inline const std::vector<PanelClass> kScreenClasses = {PanelClass::kNone, PanelClass::kScreen};
inline constexpr int kPhotoWidth = 320, kPhotoHeight = 240;

/// The screen's rectangle turned by `turn` radians about the vertical line through its middle, at the distance z.
struct Screen {
  double z = kStanding, low = kLowStanding, turn = 0;
  float luma = 0.04f;

  Vec3d normal() const { return {std::sin(turn), 0, -std::cos(turn)}; }
  Vec3d across() const { return {std::cos(turn), 0, std::sin(turn)}; }
};
inline Screen hanging() { return {kHanging, kLowHanging}; }

inline ScenePlane plane(const Vec3d& normal, double offset, PlaneKind kind) {
  ScenePlane out;
  out.normal = normal;
  out.offset = offset;
  out.kind = kind;
  return out;
}
inline std::vector<ScenePlane> planes() {
  return {plane({0, 0, -1}, kWall, PlaneKind::kWall), plane({0, -1, 0}, kScreenFloor, PlaneKind::kFloor)};
}

inline Camera camera(double x, double y, double turn) {
  Camera out;
  out.width = kPhotoWidth;
  out.height = kPhotoHeight;
  out.fx = out.fy = 240;
  out.cx = kPhotoWidth / 2.0;
  out.cy = kPhotoHeight / 2.0;
  const double c = std::cos(turn), s = std::sin(turn);
  out.world_to_camera.rotation = Mat3d{{c, 0, -s, 0, 1, 0, s, 0, c}};
  out.world_to_camera.translation = -(out.world_to_camera.rotation * Vec3d{x, y, 0});
  return out;
}

struct ScreenPhoto {
  PlaneView view;  ///< true depth
  ImageF luma;
};

inline ScreenPhoto photo(const Camera& camera, const Screen& screen) {
  ScreenPhoto out;
  out.view.camera = camera;
  out.view.depth = ImageF(kPhotoWidth, kPhotoHeight, 1);
  out.view.labels = Image<uint16_t>(kPhotoWidth, kPhotoHeight, 1);
  out.luma = ImageF(kPhotoWidth, kPhotoHeight, 1);
  const Vec3d origin = camera.centre(), middle{0, 0, screen.z};
  const Mat3d to_world = transpose(camera.world_to_camera.rotation);
  for (int y = 0; y < kPhotoHeight; ++y) {
    for (int x = 0; x < kPhotoWidth; ++x) {
      float luma = 0, depth = 0;
      constexpr int kSide = 2;  // samples per pixel and side: an edge lies where it lies and not between pixels
      for (int k = 0; k < kSide * kSide; ++k) {
        const Vec3d ray = to_world * camera.ray(x + (k % kSide + 0.5) / kSide, y + (k / kSide + 0.5) / kSide);
        double z = (kWall - origin.z) / ray.z;
        float value =
            0.7f + 0.15f * static_cast<float>(wall_photos::texture(origin.x + z * ray.x, origin.y + z * ray.y));
        const auto nearer = [&](double t, float v) {
          if (!(t > 0) || t >= z) return false;
          z = t;
          value = v;
          return true;
        };
        const double floor = (kScreenFloor - origin.y) / ray.y, top = (kTop - origin.y) / ray.y,
                     front = (kFront - origin.z) / ray.z;
        nearer(floor, 0.4f);
        if (origin.z + top * ray.z > kFront) nearer(top, 0.55f);
        if (origin.y + front * ray.y > kTop) nearer(front, 0.45f);
        const double t = dot(screen.normal(), middle - origin) / dot(screen.normal(), ray);
        const Vec3d at = origin + ray * t;
        const bool inside =
            std::abs(dot(screen.across(), at - middle)) < kHalfWidth && at.y > kHigh && at.y < screen.low;
        const bool shown = inside && nearer(t, screen.luma);
        luma += value / (kSide * kSide);
        if (k > 0) continue;
        depth = static_cast<float>(z);
        out.view.labels.at(x, y) = shown ? kScreenLabel : kOtherLabel;
      }
      out.luma.at(x, y) = luma;
      out.view.depth.at(x, y) = depth;
    }
  }
  return out;
}

/// Photos from all over the room's width.
struct Photos {
  std::vector<PlaneView> views;
  std::vector<ImageF> lumas;

  explicit Photos(const Screen& screen, int count = 5) {
    for (int i = 0; i < count; ++i) {
      ScreenPhoto p = photo(camera(-0.8 + 0.4 * i, -0.3 + 0.1 * (i % 2), 0.12 * i - 0.24), screen);
      views.push_back(std::move(p.view));
      lumas.push_back(std::move(p.luma));
    }
  }

  /// The screen's depth in every photo is off by `metres` times its factor in turn.
  void misjudge(double metres, const std::vector<double>& factors = {1}) {
    for (size_t v = 0; v < views.size(); ++v) {
      for (size_t p = 0; p < views[v].depth.data.size(); ++p) {
        if (views[v].labels.data[p] == kScreenLabel)
          views[v].depth.data[p] += static_cast<float>(metres * factors[v % factors.size()]);
      }
    }
  }

  std::vector<const ImageF*> luma_pointers() const {
    std::vector<const ImageF*> out;
    for (const ImageF& luma : lumas) out.push_back(&luma);
    return out;
  }
};

}  // namespace aligngs::screen_room
