// Outline of a flat thing in one photo, and whether edges of another photo run where a plane says that it should.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/image.h"
#include "scene/camera.h"

namespace aligngs {

/// Lengths are shares of the photo's width, so that a larger photo of the same place says the same.
struct OutlineSettings {
  double label_error = 0.016;  ///< how far a teacher's outline is from the edge that it means: five pixels of 320
  double sigma = 0.0025;       ///< of the distance between an expected edge and one that is there: 0.8 pixels of 320
  double least_slope = 0.012;  ///< luma per pixel, across an edge, below which there is none: three steps of 8 bits
  double slope_share = 0.3;    ///< of its slope in the first photo that an edge has in the other, at least
  double along = 0.7;          ///< cosine between an edge of the photo and the label's outline
  int stride = 2;              ///< pixels of the label's outline between points that are taken
};

/// How luma rises in a photo, smoothed over a pixel or so: H x W x 2, per pixel to the right and down.
ImageF luma_gradient(const ImageF& luma);

/// One place on an outline.
struct OutlinePoint {
  Vec2d place;       ///< image point
  Vec2d rise;        ///< unit: the direction in which luma rises most
  double slope = 0;  ///< luma per pixel in that direction
};

/// The photo's strongest edges near the outline of a region (H x W, 1 = inside) that run along with it. A cut by the
/// border of the photo is no outline. Empty for a region without edges.
std::vector<OutlinePoint> outline_of(const Image<uint8_t>& region, const ImageF& gradient,
                                     const OutlineSettings& settings);

/// A plane in the world: normal . x + offset = 0.
struct WorldPlane {
  Vec3d normal;
  double offset = 0;
};

struct OutlineAgreement {
  /// in [0, 1]: of the points that fall into the other photo, each as much as an edge of it is near
  double share = 0;
  double inside = 0;  ///< share of all points that fall into it
};

/// Takes outline points of one photo onto a plane and from there into another photo, and looks for edges there that run
/// and rise alike. `gradient` is that of the other photo. A plane behind either camera, or seen from its other side by
/// one of them: nothing.
OutlineAgreement agreement(const std::vector<OutlinePoint>& outline, const Camera& camera, const WorldPlane& plane,
                           const Camera& other, const ImageF& gradient, const OutlineSettings& settings);

/// The world points where rays through an outline meet a plane; those whose rays do not are left out.
std::vector<Vec3d> on_plane(const std::vector<OutlinePoint>& outline, const Camera& camera, const WorldPlane& plane);

}  // namespace aligngs
