// Prior depth brought to the planes of the room where the labels say wall, floor or ceiling.
#pragma once

#include <vector>

#include "core/image.h"
#include "core/thread_pool.h"
#include "refine/room_axes.h"
#include "refine/scene_planes.h"
#include "scene/camera.h"
#include "scene/label_set.h"

namespace aligngs {

/// One photo. Maps have the camera's size.
struct PlaneView {
  Camera camera;
  ImageF depth;            ///< scene units, 0 = none
  ImageF certainty;        ///< in [0, 1]: of the depth, where stereo measured it; may be empty
  Image<uint16_t> labels;  ///< class per pixel, kNoLabel = none; empty: the photo has no say
  /// in [0, 1]: how sure the label is; a pixel's weight on a plane is multiplied by it; empty: 1
  ImageF label_share;
};

struct PlaneDepthSettings {
  PlaneSettings planes;
  int stride = 3;       ///< pixels between the points that planes are found with
  int label_edge = 3;   ///< pixels from another label: a teacher's outlines are wrong by so much
  double reach = 0.12;  ///< |log(plane / depth)| within which a pixel is on a plane
  /// and within which a window or mirror is in its wall: networks see through or behind it
  double glass_reach = 0.5;
  double normal_angle = 30;  ///< degrees between the depth's own normal and the plane's
  double strength = 3;       ///< weight of a pixel on a plane, where a sure stereo measurement weighs 1
  bool square = false;       ///< planes of a room that is built square are turned to its axes (refine/room_axes.h)
};

/// Per view what planes say: the log factor that takes the depth to its plane, its weight, and 1 + the plane's index; 0
/// where none.
struct PlaneMeasurement {
  ImageF log_factor, weight;
  Image<uint8_t> plane;
};

/// A plane in a camera's frame, from the side that the camera is on.
struct CameraPlane {
  Vec3d normal;     ///< unit, to the camera's side
  double distance;  ///< of the camera's centre, scene units, > 0
  PlaneKind kind;
  uint8_t number;    ///< 1 + index among the planes of the scene
  double proud = 0;  ///< how far before it doors, pictures and rugs lie (ScenePlane), scene units

  /// Depth along a ray with z = 1, of the plane or of a surface proud of it; 0: not in front.
  double depth(const Vec3d& ray, bool of_proud = false) const {
    const double slope = -dot(normal, ray), away = distance - (of_proud ? proud : 0);
    return slope > 0 && away > 0 ? away / slope : 0;
  }
};

/// The kinds without pixels near another: 0 unless all pixels within `edge` (at the border, those inside) are the same.
Image<uint8_t> interior(const Image<uint8_t>& kinds, int edge);

/// The planes that a camera sees from their front; of the first 255, which are more than find_planes() finds.
std::vector<CameraPlane> in_frame_of(const Camera& camera, const std::vector<ScenePlane>& planes);

/// The plane of a kind that a ray with z = 1 meets first; null without one.
const CameraPlane* first_on_ray(const std::vector<CameraPlane>& planes, PlaneKind kind, const Vec3d& ray);

struct PlaneDepthResult {
  std::vector<ScenePlane> planes;
  std::vector<PlaneMeasurement> views;
  /// that the planes were turned to; nothing where the room is not square or nobody asked
  std::optional<RoomAxes> axes;
  double share = 0;  ///< of the pixels with depth that lie on a plane
};

/// Meaning of a class for the place of a surface.
struct PlaneClass {
  PlaneKind kind = PlaneKind::kNone;
  bool glass = false;  ///< its depth says nothing of the plane
  bool proud = false;  ///< it is a little before the plane
};

/// Named surfaces that are planes.
enum class PlaneSurfaces {
  /// wall, floor and ceiling: rugs lie on the floor; doors, pictures, windows and mirrors are part of walls
  kLayout,
  kLayoutAndTables  ///< and the tops of tables, desks and counters
};

/// For each class of a label set, by name.
std::vector<PlaneClass> plane_classes(const LabelSet& labels, PlaneSurfaces surfaces = PlaneSurfaces::kLayout);

/// The planes of measure_planes() alone, without what they say of each pixel.
std::vector<ScenePlane> find_planes(const std::vector<PlaneView>& views, const std::vector<PlaneClass>& classes,
                                    const PlaneDepthSettings& settings, ThreadPool& pool);

/// Deterministic for any number of threads. No labels, or nothing flat: no planes, and weights of 0.
PlaneDepthResult measure_planes(const std::vector<PlaneView>& views, const std::vector<PlaneClass>& classes,
                                const PlaneDepthSettings& settings, ThreadPool& pool);

/// Effect of `planes` on each pixel.
std::vector<PlaneMeasurement> measure_on_planes(const std::vector<ScenePlane>& planes,
                                                const std::vector<PlaneView>& views,
                                                const std::vector<PlaneClass>& classes,
                                                const PlaneDepthSettings& settings, ThreadPool& pool);

}  // namespace aligngs
