// The colours of a texture: from the photos that see a place best, and from the splats where none does.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"
#include "core/thread_pool.h"
#include "edit/export/texture_photos.h"
#include "gaussians/gaussian_model.h"
#include "mesh/chart_atlas.h"

namespace aligngs {

struct BakeSettings {
  int patch = 16;         ///< texels, edge of the squares of a chart for which photos are chosen
  int photos = 3;         ///< per patch, the best ones
  double sharpening = 2;  ///< power of the weights: more, and the best photo alone decides
  /// / extent: a texel is on the photographed surface when this near, along its normal (1.5 cm)
  double tolerance = 0.005;
  double least_cosine = 0.1;  ///< between a texel's normal and the ray: beyond 84 degrees a photo says nothing
  double border = 0.05;       ///< of the photo's width: weights rise over this from its edge
  int silhouette = 3;         ///< pixels around a jump of depth that may show the other surface
  double silhouette_weight = 0.05;
  double splat_weight = 1e-4;  ///< of the splats beside photos, of which one that looks straight at a place has 1
};

struct BakeReport {
  size_t texels = 0;       ///< of charts
  size_t from_photos = 0;  ///< of them
};

/// RGB of the atlas's size. `photographed`, per triangle: 1 where edits have changed neither place nor colour. Photos
/// of a patch are weighted by angle, resolution, sharpness and the distance from the photo's edge and from silhouettes;
/// neighbouring patches blend. The same for any number of threads.
Image<uint8_t> bake_texture(const TriangleMesh& mesh, const Atlas& atlas, const std::vector<uint8_t>& photographed,
                            const TexturePhotos& photos, const GaussianModel& splats, double extent, ThreadPool& pool,
                            const BakeSettings& settings = {}, BakeReport* report = nullptr);

}  // namespace aligngs
