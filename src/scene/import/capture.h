// A posed capture in one of the field's folder layouts, before views are chosen and files are written.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/rigid.h"
#include "io/colmap.h"
#include "scene/point_cloud.h"

namespace aligngs {

struct CapturedFrame {
  std::string name;             ///< stem of the image in the scene folder, unique in the capture
  std::filesystem::path image;
  std::filesystem::path depth;  ///< PNG, uint16; empty when there is none
  ColmapCamera camera;          ///< camera model of the image, lens distortion included
  Rigidd world_to_camera;       ///< OpenCV axes
};

/// The depth sensor where it is not the colour camera.
struct DepthCamera {
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels of the depth image, COLMAP's half-pixel convention
  Rigidd to_color;                        ///< depth-camera frame to colour-camera frame
};

struct Capture {
  std::string layout;                  ///< name of the layout, e.g. "scannet"
  std::filesystem::path folder;
  std::vector<CapturedFrame> frames;   ///< with finite poses only, in capture order
  std::vector<std::string> skipped;    ///< one line per frame left out and why
  double depth_unit = 0.001;           ///< scene units per stored depth value
  std::optional<DepthCamera> depth_camera;  ///< empty: depth is registered to colour
  bool metric = false;                 ///< scene units are metres
  std::optional<Vec3d> up;             ///< world, unit
  std::filesystem::path mesh;          ///< reference mesh in the same world; empty when there is none
  std::vector<std::string> train, test;  ///< a split that comes with the capture; empty when there is none
  PointCloud cloud;                    ///< SfM points that come with it; may be empty
};

enum class CaptureLayout { kAuto, kRgbd, kSevenScenes, kTum, kScanNet, kNeuralRgbd, kReplica, kTransforms, kColmap };

struct CaptureOptions {
  CaptureLayout layout = CaptureLayout::kAuto;
  std::filesystem::path intrinsics;   ///< 3x3 or 4x4 matrix file; required by TUM and unregistered 7-Scenes
  bool assume_registered = false;     ///< 7-Scenes: treat the shipped colour as registered to depth
  bool neural_rgbd_trajectory = false;  ///< Neural RGB-D: trainval_poses.txt (BundleFusion) instead of poses.txt
};

/// Recognises the layout and reads the frame list. Poses that are not finite are skipped and listed.
/// Error{kBadInput} when nothing matches, naming what was looked for.
Capture read_capture(const std::filesystem::path& folder, const CaptureOptions& options = {});
std::string layout_name(CaptureLayout layout);

// One reader per layout; each documents the files it expects at the top of its .cpp.
Capture read_rgbd_folder(const std::filesystem::path& folder);
Capture read_seven_scenes(const std::filesystem::path& folder, const CaptureOptions& options);
Capture read_tum(const std::filesystem::path& folder, const CaptureOptions& options);
Capture read_scannet(const std::filesystem::path& folder);
Capture read_neural_rgbd(const std::filesystem::path& folder, const CaptureOptions& options);
Capture read_replica(const std::filesystem::path& folder);
Capture read_transforms(const std::filesystem::path& folder);
Capture read_colmap_capture(const std::filesystem::path& folder);

/// One frame per image of a COLMAP model, in its order; `image` is left empty.
std::vector<CapturedFrame> frames_of_model(const ColmapModel& model);

/// Depth of a frame in scene units, registered to the (undistorted) colour camera, 0 = none; empty image when the
/// frame has none. 0 and 65535 are "no value" in every layout.
ImageF read_capture_depth(const Capture& capture, const CapturedFrame& frame);

/// Scales a capture's camera model to images of another size (maps or resized photos).
ColmapCamera pinhole_camera(double fx, double fy, double cx, double cy, int width, int height);

}  // namespace aligngs
