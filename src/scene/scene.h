// A scene folder: views with cameras, priors and truth, before any pixel is loaded.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/left_out.h"
#include "scene/camera.h"
#include "scene/label_set.h"
#include "scene/point_cloud.h"

namespace aligngs {

/// How the numbers in segmentation_logits/ become class probabilities (design, section 4).
enum class SemanticKind {
  kLogits,         ///< softmax
  kScores,         ///< Mask2Former scores of about [0, 1]: s / sum s
  kProbabilities,  ///< used as they are
};

/// Unit of the numbers in pred_depths/ (scene/depth_placement.h brings them to that of the scene).
enum class DepthScale {
  kScene,   ///< scene units: made or corrected together with these cameras, or a sensor's
  kMetres,  ///< metres, by a network that sees one photo at a time
  /// one unknown scale for all views: a network that sees all photos, whose cameras are not those of the scene
  kOwn,
  kPerView,  ///< an unknown scale for every view
};

/// One photo of the scene. Paths are absolute; an empty path means that the map is absent.
struct View {
  std::string name;  ///< stem of the image file: up to the last dot
  Camera camera;     ///< at the size of the image
  std::filesystem::path image;
  std::filesystem::path mask;          ///< of the photo (photo_mask.h)
  std::filesystem::path prior_depth;   ///< pred_depths/<stem>.npy
  std::filesystem::path semantics;     ///< segmentation_logits/<stem>.npz, .npy or .pt
  std::filesystem::path truth_depth;   ///< truth/depth/<stem>.png, uint16 millimetres, 0 = none
  std::filesystem::path truth_labels;  ///< truth/labels/<stem>.png, uint8, 255 = none
  std::optional<Camera> truth_camera;  ///< from truth/sparse; never used by training
  Vec3f log_gain;  ///< exposure.json: of red, green, blue in linear light, against the mean photo; 0 = unknown
};

/// priors.json depth.model of depth that no network made: a depth camera's, or measured in the photos
/// (refine/measured_scene.h).
inline constexpr const char* kSensorDepth = "sensor";
inline constexpr const char* kSimulatedSensorDepth = "simulated time-of-flight sensor";  ///< `synth --depth sensor`
/// True for either.
bool is_sensor_depth(const std::string& prior_source);
inline constexpr const char* kStereoDepth = "stereo";

/// scene.json units_estimate: a network guessed the metres of a scene whose photos do not tell them.
struct UnitsEstimate {
  std::string model;  ///< that guessed
  double spread = 0;  ///< standard deviation of the logarithm of the photos' own scales, >= 0
  int photos = 0;     ///< that had a scale of their own
};

struct Scene {
  std::filesystem::path folder;
  bool metric = false;                          ///< scene.json units == "metres"
  std::optional<UnitsEstimate> units_estimate;  ///< absent: the metres are given, measured or unknown
  std::optional<Vec3d> up;                      ///< unit, world
  std::string source;                           ///< scene.json source: what made this scene
  std::string prior_source;  ///< priors.json depth.model, e.g. "sensor", "simulated", ""; shown in reports
  DepthScale depth_scale = DepthScale::kScene;  ///< priors.json depth.scale, or what an older file means (scene_json.h)
  bool depth_scale_stated = false;              ///< priors.json has depth.scale
  std::string semantic_source;                  ///< priors.json semantics.model, likewise
  SemanticKind semantic_kind = SemanticKind::kLogits;
  bool semantic_kind_stated = false;  ///< priors.json says the kind; false: taken as logits, as in the paper
  std::vector<View> views;            ///< sorted by name
  std::vector<int> train, test;       ///< indices into views
  PointCloud cloud;                   ///< sparse/points3D
  LabelSet labels;
  /// classes whose pixels are left out of photos and depth (ignored_classes.h); open_scene sets none
  std::vector<int> ignored;
  std::filesystem::path truth_mesh;        ///< truth/mesh.ply or empty
  std::vector<LeftOut> left_out;           ///< views that would train or test but cannot be used, and why
  std::vector<Camera> evaluation_cameras;  ///< truth/sparse cameras of all views, else the views' own cameras

  bool has_prior_depth() const;    ///< every training view has one
  bool has_semantics() const;      ///< every training view has one
  bool has_network_depth() const;  ///< and a network made it, simulated or not
};

/// Opens a scene folder: sparse/ or sparse/0/ (bin or txt), split.json, labels.csv, scene.json, priors.json. Photos are
/// found by PhotoLookup; they may have been resized after the cameras were found. Without split.json every view is a
/// training view (`default_test_every` > 0: every n-th is a test view). Views that cannot be used (no finite pose, no
/// photo, a cut file, a map that others have missing) are left out and listed. Error{kBadInput} naming file and field
/// where it is not one view, and when fewer than kFewestTrainingViews are left of more. Checks names and headers, not
/// pixels; see check_scene.
inline constexpr size_t kFewestTrainingViews = 2;  ///< one has no parallax
struct SceneOptions {
  int default_test_every = 0;
  /// Leave out views whose image or maps are missing or contradict the scene. false: leave that to check_scene, which
  /// lists all of them (`aligngs data check`).
  bool check_headers = true;
};
Scene open_scene(const std::filesystem::path& folder, const SceneOptions& options = {});

/// The name of a view's image in a model of this scene: its path below images/, or below the scene's folder.
std::string image_name_of(const Scene& scene, const View& view);

/// Robust size of a scene: every threshold of the method that is a length is a share of this.
/// Half the diagonal of the box between the 5 % and 95 % quantiles of the cloud's points and the training
/// camera centres, never zero. Invariant under rotation up to the box, linear in scale.
double robust_extent(const Scene& scene);

/// A digest of what a scene holds (names, sizes, cameras, split), for run.json.
std::string scene_fingerprint(const Scene& scene);

}  // namespace aligngs
