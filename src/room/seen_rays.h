// The pixels of all photos as labelled rays in the room's frame.
#pragma once

#include <cstdint>
#include <vector>

#include "core/rigid.h"
#include "refine/plane_depth.h"

namespace aligngs {

/// From a camera to the surface that a pixel shows.
struct SeenRay {
  Vec3d from, to;
  uint16_t label = 0;  ///< class or kNoLabel
};

/// Every `stride`-th pixel with depth, transformed by `to_room`. With `edge` > 0 a pixel within so many pixels of
/// another class has no label: outlines of labels are wrong by so much. Pixels without finite positive depth are left
/// out.
std::vector<SeenRay> seen_rays(const std::vector<PlaneView>& views, const Similarity& to_room, int stride, int edge);

}  // namespace aligngs
