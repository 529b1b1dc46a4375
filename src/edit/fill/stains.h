// Stains that removed objects leave on the surfaces around them: mixtures with their colour, and their shade.
#pragma once

#include <cstdint>
#include <vector>

#include "edit/fill/fill_removed.h"
#include "edit/fill/near_cells.h"
#include "gaussians/point_tree.h"

namespace aligngs {

class Stains {
 public:
  /// World positions of Gaussians that go; `furniture` are those of objects that rest on the floor.
  Stains(const LabelledGaussians& room, std::vector<Vec3f> removed, std::vector<Vec3f> furniture,
         const FillSettings& settings);

  /// Whether a place is nearer to a removed object than a share of the extent.
  bool is_beside(const Vec3d& place, double share) const { return is_near(removed_, place.cast<float>(), share); }

  /// The Gaussians of a surface apart from the removed objects, for is_stain().
  struct Surface {
    std::vector<uint32_t> rows;
    PointTree tree;  ///< over the rows' places
  };
  Surface surface_of(std::vector<uint32_t> rows) const;

  /// Whether a Gaussian near a removed object is not as its surface is farther off. It has a colour that the surface
  /// lacks, or is darker than the surface's pattern in the shade of furniture.
  bool is_stain(size_t row, const Surface& surface) const;
  /// Whether a row is darker than the surface's pattern, wherever it is.
  bool is_shade(size_t row, const Surface& surface) const;
  /// Whether no Gaussian of the surface near by has about the colour of a row. It is true of an empty surface.
  bool is_foreign(size_t row, const Surface& surface) const;

 private:
  /// Brightness of the dark colours of some of a surface's Gaussians; some, not none.
  float dark_of(const std::vector<PointTree::Neighbour>& near, const Surface& surface) const;
  bool is_near(const PointTree& tree, const Vec3f& place, double share) const;

  const LabelledGaussians& room_;
  const FillSettings& settings_;
  NearCells beside_, shaded_;  ///< most places are far from both, and trees take long for these
  PointTree removed_, furniture_;
};

}  // namespace aligngs
