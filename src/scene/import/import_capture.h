// From a capture to a scene folder: views chosen, lenses undistorted, cloud and depth written.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/thread_pool.h"
#include "scene/import/capture.h"

namespace aligngs {

struct ImportOptions {
  // Choice of the frames that train and test. At most one of views, stride and train_names is given. Without them the
  // capture's own split holds, else all frames train (more than kMaxUnselected frames are thinned to kDefaultViews).
  int views = 0;                         ///< so many well-spread sharp views
  int stride = 0;                        ///< every n-th frame
  std::vector<std::string> train_names;  ///< exactly these
  std::vector<std::string> test_names;   ///< exactly these; they do not train unless train_names has them
  /// so many instead, of frames that do not train, or held out where all would; -1: a third of the training views
  int test_views = -1;

  bool depth_prior = true;  ///< sensor depth of training views also becomes pred_depths/
  /// COLMAP model for the cloud, aligned on its cameras; then no sensor depth is used
  std::filesystem::path sfm;
  bool neuris_crop = false;        ///< ScanNet as NeuRIS prepares it: centre crop 1248/1296, resized to 640x480
  double voxel = 0;                ///< edge of the cubes that thin the fused cloud, scene units; 0: automatic
  int max_side = 0;                ///< pixels; larger photos are shrunk; 0: none is
  bool strict = false;             ///< a frame that cannot be used is an error instead of being left out
  bool overwrite = false;          ///< replace a scene that this program wrote there
  std::filesystem::path photos{};  ///< folder of the photos where it is not that of the capture
  std::vector<std::filesystem::path> sources;  ///< what was given to read; empty: the capture's folder
  ProgressStyle progress;
};

inline constexpr int kMaxUnselected = 100;  ///< frames; more is a video, not a handful of photos
inline constexpr int kDefaultViews = 36;    ///< the paper's number of training views

struct ImportReport {
  size_t train = 0, test = 0;
  std::vector<LeftOut> left_out;  ///< frames of the capture and of the lists that are not in the scene, and why
  size_t points = 0;
  std::string cloud_source;  ///< "sensor depth", "sfm", "capture", "none"
  double sfm_rmse = 0;       ///< residual of the alignment on camera centres, scene units
  size_t sfm_cameras = 0;    ///< cameras it was aligned on
  bool depth_prior = false;
  std::vector<std::string> warnings;  ///< of the check that training begins with, which do not forbid it
};

/// Frames that cannot be used are left out, with a line each and a summary in the log. Error{kBadInput} for names that
/// do not exist, and when fewer than kFewestTrainingViews are left of more, or left by options (capture_split.h). Also
/// for anything that training would refuse: the scene passes training's check before it takes its place. The folder
/// appears complete or not at all.
ImportReport import_capture(const Capture& capture, const std::filesystem::path& output, const ImportOptions& options,
                            ThreadPool& pool);

/// SfM points of a COLMAP model brought into the capture's world by the similarity of their common cameras.
struct AlignedSfm {
  PointCloud cloud;
  double rmse = 0;
  size_t cameras = 0;
};
AlignedSfm align_sfm(const Capture& capture, const std::filesystem::path& model_folder);

}  // namespace aligngs
