// How believable a room is after a deletion, where the scene knows the room without the object (`aligngs synth
// --without`).
#pragma once

#include <filesystem>
#include <vector>

#include "core/image.h"
#include "core/thread_pool.h"
#include "scene/camera.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

struct RemovalScoreOptions {
  double margin = 0.01;          ///< of the picture's width: the mask of the object is widened by it
  size_t fewest_pixels = 100;    ///< of a mask: views that hardly show the object do not count
  double threshold = 0.05;       ///< metres: surfaces nearer than this are the same (the project's F-score distance)
  double points_per_area = 1e4;  ///< samples per m^2
};

struct RemovalScore {
  size_t views = 0;                              ///< that show the object and counted
  double psnr = 0;                               ///< dB, over the pixels of the masks of all views
  double ssim = 0;                               ///< mean over the views
  double precision = 0, recall = 0, fscore = 0;  ///< in the boxes of the objects, of surface that the cameras can see
};

/// `renders` holds <view>.png of the edited room, `truth` is truth/without/<name> of the scene, `cameras` look at the
/// room from where photos were taken. Error{kBadInput} naming a file that is missing, or whose size differs.
RemovalScore score_removal(const std::filesystem::path& renders, const std::filesystem::path& truth,
                           const TriangleMesh& mesh, const std::vector<Camera>& cameras, ThreadPool& pool,
                           const RemovalScoreOptions& options = {});

/// The mask of an object widened by `radius` pixels.
ImageF widened_mask(const Image<uint8_t>& mask, int radius);

}  // namespace aligngs
