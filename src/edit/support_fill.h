// Filling for a deleted object: the plane that carried it, continued over the hole.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "edit/selection.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

struct SupportOptions {
  double link = 0.03;        ///< / extent: nearer Gaussians are of one part (10 cm in a room)
  double ring = 0.06;        ///< / extent: Gaussians this near to the selection are its surroundings (20 cm)
  double tolerance = 0.008;  ///< / extent: distance from the plane within which a Gaussian lies on it (3 cm)
  double cell_min = 0.002, cell_max = 0.01;  ///< / extent: edge of a cell of the patch
  int trials = 400;                          ///< of the random sample consensus (Fischler and Bolles 1981)
  uint64_t seed = 1;
};

/// The plane normal . x = offset; the deleted object lies on the side that the normal points to.
struct SupportPlane {
  Vec3d normal;
  double offset = 0;
  std::vector<uint32_t> carriers;  ///< rows of the surrounding Gaussians that lie on it
};

/// The selection in connected parts: separate things have supporting planes of their own. One mask per part, the part
/// with the smallest row first; parts of fewer than 20 Gaussians leave no hole worth filling.
std::vector<std::vector<uint8_t>> connected_parts(const LabelledGaussians& room, const std::vector<uint8_t>& selected,
                                                  const SupportOptions& options = {});

/// A patch for the hole.
struct SupportPatch {
  GaussianModel gaussians;        ///< flat, on the plane, coloured and labelled like their surroundings
  std::vector<uint32_t> sources;  ///< per new Gaussian: the row it takes its class from
  TriangleMesh mesh;              ///< the same area, one cell wider
};

/// The plane with most of the surroundings on it and the object on one side; with `up`, planes under the object count
/// up to twice. Then, if there is one at more than 66 degrees to it, the plane that the object leaned on. A pillow lies
/// on a bed and before its headboard. Empty when the surroundings have no plane. `part` is one part of the `selected`
/// Gaussians, all of which go.
std::vector<SupportPlane> find_supports(const LabelledGaussians& room, const std::vector<uint8_t>& part,
                                        const std::vector<uint8_t>& selected, const std::optional<Vec3d>& up,
                                        const SupportOptions& options = {});

/// Covers what the part covered of the plane and nothing that stays covers. Empty when there is no hole.
SupportPatch fill_on_plane(const LabelledGaussians& room, const std::vector<uint8_t>& part,
                           const std::vector<uint8_t>& selected, const SupportPlane& plane,
                           const SupportOptions& options = {});

}  // namespace aligngs
