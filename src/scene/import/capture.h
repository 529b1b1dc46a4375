// A posed capture in one of the field's folder layouts, before views are chosen and files are written.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/rigid.h"
#include "io/colmap.h"
#include "io/left_out.h"
#include "scene/photo_lookup.h"
#include "scene/point_cloud.h"

namespace aligngs {

struct CapturedFrame {
  /// of the view in the scene folder, without extension, subfolders kept; unique in the capture
  std::string name;
  std::filesystem::path image;
  /// the camera is for the pixels after EXIF orientation; else for those stored (photo_fit.h)
  bool upright = false;
  std::filesystem::path depth;       ///< PNG, uint16; empty when there is none
  std::filesystem::path confidence;  ///< of the depth, PNG of its size, 0 = not to be trusted; empty when there is none
  std::filesystem::path mask;  ///< picture of the image's aspect, 0 = do not use this pixel; empty when there is none
  ColmapCamera camera;         ///< camera model at the size of the image, lens distortion included
  double depth_scale = 1;      ///< of this frame's depth: the uniform scale of a pose that has one
  Rigidd world_to_camera;      ///< OpenCV axes
};

/// The depth sensor where it is not the colour camera.
struct DepthCamera {
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels of the depth image, COLMAP's half-pixel convention
  Rigidd to_color;                        ///< depth-camera frame to colour-camera frame
  std::filesystem::path file;             ///< that has the intrinsics
};

/// SfM points before they are brought near the origin, in double precision.
struct CapturedCloud {
  std::vector<Vec3d> positions;  ///< world
  std::vector<Vec3f> colors;     ///< sRGB in [0, 1]
  size_t size() const { return positions.size(); }
};

struct Capture {
  std::string layout;  ///< name of the layout, e.g. "scannet"
  std::filesystem::path folder;
  std::vector<CapturedFrame> frames;        ///< with finite poses only, in capture order
  std::vector<LeftOut> left_out;            ///< frames that cannot be used, and why
  std::vector<std::string> notes;           ///< what was found and not used although it may matter, a sentence each
  std::string depth_files;                  ///< of a layout with depth: their place, as "depth/NAME.png"; else empty
  double depth_unit = 0.001;                ///< scene units per stored depth value
  std::optional<DepthCamera> depth_camera;  ///< empty: depth is registered to colour
  bool metric = false;                      ///< scene units are metres
  std::optional<Vec3d> up;                  ///< world, unit
  bool up_measured = false;                 ///< by a sensor of gravity, as telephones have
  std::string up_source;                    ///< where it comes from, e.g. "ScanNet's convention (+z)"
  std::optional<Similarity> to_original;    ///< from this world to the files' own, where it was moved or scaled
  std::filesystem::path mesh;               ///< reference mesh in the files' own world; empty when there is none
  std::vector<std::string> train, test;     ///< a split that comes with the capture; empty when there is none
  CapturedCloud cloud;                      ///< SfM points that come with it; may be empty
};

struct CaptureOptions {
  std::string layout = "auto";          ///< a name of capture_layouts(), or "auto"
  std::filesystem::path intrinsics{};   ///< 3x3 or 4x4 matrix file; required by TUM and unregistered 7-Scenes
  bool assume_registered = false;       ///< 7-Scenes: treat the shipped colour as registered to depth
  bool neural_rgbd_trajectory = false;  ///< Neural RGB-D: trainval_poses.txt (BundleFusion) instead of poses.txt
};

/// A layout of the field, as a row. The choices, the help and the messages of `import --layout` follow from it, as do
/// the order of "auto" and the table of docs/formats.md.
struct CaptureLayout {
  const char* name;   ///< of --layout
  const char* title;  ///< as people call it
  const char* files;  ///< by which its folder is recognised
  bool (*found)(const std::filesystem::path& folder);
  Capture (*read)(const std::filesystem::path& folder, const CaptureOptions& options);
};

/// In the order of recognition: the first that is found is taken.
const std::vector<CaptureLayout>& capture_layouts();

/// The layout that the names of a folder's files tell; nullptr: none.
const CaptureLayout* recognise_layout(const std::filesystem::path& folder);
/// The same without COLMAP and nerfstudio, whose cameras other commands read as well.
const CaptureLayout* recognise_posed_capture(const std::filesystem::path& folder);
/// Error{kBadInput} with this remedy for such a folder: as photos alone it would lose its cameras, and depth would count
/// as photos.
void refuse_posed_capture(const std::filesystem::path& folder, const std::string& remedy);
/// All layouts with their files, for messages.
std::string known_layouts();

/// Recognises the layout and reads the frame list. Frames that cannot be used are left out and listed. A world far from
/// its origin, or of arbitrary units and a size far from 1, is moved and scaled (place_near_origin). Error{kBadInput}
/// when nothing matches, naming what was looked for, and when no frame is left. Error{kUsage} for a layout that is no
/// name of one.
Capture read_capture(const std::filesystem::path& folder, const CaptureOptions& options = {});

// One reader per layout; each documents the files it expects at the top of its .cpp.
Capture read_rgbd_folder(const std::filesystem::path& folder, const CaptureOptions& options);
Capture read_seven_scenes(const std::filesystem::path& folder, const CaptureOptions& options);
Capture read_tum(const std::filesystem::path& folder, const CaptureOptions& options);
Capture read_scannet(const std::filesystem::path& folder, const CaptureOptions& options);
Capture read_neural_rgbd(const std::filesystem::path& folder, const CaptureOptions& options);
Capture read_replica(const std::filesystem::path& folder, const CaptureOptions& options);
Capture read_polycam(const std::filesystem::path& folder, const CaptureOptions& options);
Capture read_scanner_app(const std::filesystem::path& folder, const CaptureOptions& options);
/// Whether a folder looks like one of these two.
bool may_hold_polycam(const std::filesystem::path& folder);
bool may_hold_scanner_app(const std::filesystem::path& folder);
Capture read_transforms(const std::filesystem::path& folder, const CaptureOptions& options = {});
Capture read_colmap_capture(const std::filesystem::path& folder, const CaptureOptions& options = {});

/// The same two for photos that lie elsewhere than their cameras.
Capture read_transforms(const std::filesystem::path& folder, const PhotoLookup& photos);
Capture read_colmap_capture(const std::filesystem::path& folder, const PhotoLookup& photos);
/// transforms.json, or Blender's transforms_train.json.
bool may_hold_transforms(const std::filesystem::path& folder);

/// The last step of every reader. Left out are frames listed twice, photos with two cameras, and frames without depth
/// if most have one. The world is placed near its origin. Error{kBadInput} when no frame is left.
void finish_capture(Capture& capture);

/// Depth of a frame in scene units, registered to the (undistorted) colour camera, 0 = none; empty image when the
/// frame has none. 0 and 65535 are "no value" in every layout.
ImageF read_capture_depth(const Capture& capture, const CapturedFrame& frame);

ColmapCamera pinhole_camera(double fx, double fy, double cx, double cy, int width, int height);

}  // namespace aligngs
