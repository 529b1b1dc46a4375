// Photos in, a scene folder out: cameras and a cloud found by a network or COLMAP, or given.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/thread_pool.h"
#include "nn/compute.h"
#include "priors/colmap_poses.h"
#include "priors/metres_estimate.h"
#include "priors/model_store.h"
#include "priors/photo_folder.h"
#include "priors/poses_method.h"
#include "priors/predicted_view.h"

namespace aligngs {

struct ScenePhotosOptions {
  PosesMethod method = PosesMethod::kVggt;  ///< never kAuto
  int max_side = 1600;                      ///< pixels; larger photos are shrunk, as 3DGS' tools do
  int test_every = 0;                       ///< every n-th photo is kept for testing; 0: all train
  int video_views = 40;                     ///< frames to take of a video, at most
  bool overwrite = false;
  /// a photo that cannot be used, or without a camera, is Error{kBadInput} instead of being left out
  bool strict = false;

  // Networks for cameras.
  std::string model;  ///< name of the weights, of the method's network; unused by a method without one
  double drop_percent = kUnsureDepthPercent;  ///< depth of the lowest confidence that is not used, percent of all
  bool shared_focal = false;
  bool camera_from_rays = false;              ///< Depth Anything 3
  MetresChoice metres = MetresChoice::kAuto;  ///< Depth Anything 3: the network kMetricModel beside it
  size_t max_points = 250000;                 ///< of the cloud
  nn::Precision precision = nn::Precision::kBfloat16;
  nn::DeviceFactory make_device = {};  ///< where networks run; empty: the processor
  uint64_t memory_limit = 0;           ///< bytes; 0: 80 % of what is free

  // Given: a COLMAP model's folder or a transforms.json; empty: looked for beside the photos.
  std::filesystem::path cameras;

  // COLMAP.
  bool shared_camera = true;

  int threads = 0;
  ProgressStyle progress;
};

struct ScenePhotosReport {
  std::string method;  ///< "vggt-1b", "da3-base", "colmap", "given"
  size_t photos = 0, placed = 0, points = 0, train = 0, test = 0;
  std::vector<LeftOut> unplaced;         ///< photos that are not in the scene, and why
  double reprojection_error = 0;         ///< pixels; COLMAP
  std::optional<MetresEstimate> metres;  ///< Depth Anything 3 beside a metric network
  double seconds = 0;
};

struct CheckedPhotos {
  PhotoList listed;               ///< nothing of a video, whose frames are not there yet
  std::filesystem::path cameras;  ///< of kGiven
};
/// The checks of make_scene_from_photos() before it makes anything; changes nothing. Its errors, those of photos that
/// could not be placed aside; Error{kFailed} where the program colmap or ffmpeg is needed and missing.
CheckedPhotos check_photos(const std::filesystem::path& photos, const std::filesystem::path& scene,
                           const ModelStore& store, const ScenePhotosOptions& options);

/// `photos`: a folder, or a video, whose frames become photos (priors/video_frames.h).
/// Error{kUsage} when the scene exists, or for a video with given cameras. Error{kWeights} when the network's weights
/// are missing. Error{kResources} when memory is too small. Error{kBadInput}, with a reason per photo, when fewer than
/// three photos or fewer than half could be placed.
ScenePhotosReport make_scene_from_photos(const std::filesystem::path& photos, const std::filesystem::path& scene,
                                         const ModelStore& store, const ScenePhotosOptions& options);

}  // namespace aligngs
