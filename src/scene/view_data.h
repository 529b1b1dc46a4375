// The pixels and prior maps of one view, loaded and brought to the size at which the run works.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"
#include "scene/scene.h"

namespace aligngs {

/// Scores whose sum lies below this say nothing about a pixel (Mask2Former's "no object").
inline constexpr double kUnknownScoreSum = 0.3;

/// The teacher's class probabilities at their native resolution (which may be smaller than the image).
struct SemanticTarget {
  int channels = 0;  ///< number of classes C
  int width = 0, height = 0;
  /// float16 probabilities, [height][width][channels]: one pixel's classes are contiguous and sum to 1 but for their
  /// rounding.
  std::vector<uint16_t> probabilities;
  /// One per target pixel: 1 / the sum of its stored numbers, by which they are multiplied wherever they are used.
  /// Rounding leaves that sum up to 5e-4 off 1, which is much beside a KL divergence of equals. Empty: 1 everywhere.
  std::vector<float> scale;
  /// One per target pixel, [0, 1]: the sum of a score teacher's numbers of the pixel, at most 1. It is low where the
  /// network found no object. Logits and probabilities: 1. Empty: 1 everywhere.
  std::vector<float> score_sum;
  /// One per target pixel, [0, 1]: 0 where the teacher says nothing.
  std::vector<float> confidence;
  bool empty() const { return probabilities.empty(); }
};

/// Everything training and evaluation need of one view. Maps have the size of `camera`.
struct ViewData {
  std::string name;
  Camera camera;  ///< resized to the working resolution
  ImageF color;   ///< H x W x 3, sRGB in [0, 1]
  /// H x W x 1, 1 = use this pixel: alpha, masks/ and Scene::ignored together; empty: all are used
  ImageF mask;
  /// H x W x 1, times LoadOptions::depth_factor, 0 = no value, also under the mask; empty when absent
  ImageF prior_depth;
  SemanticTarget semantics;  ///< empty when absent
  Image<uint16_t> labels;    ///< arg-max of the target at the camera's size, kNoLabel if unknown; empty when absent
};

struct LoadOptions {
  double scale = 1;  ///< working resolution / image resolution, e.g. 0.5 for preset `preview`
  bool prior_depth = true;
  double depth_factor = 1;  ///< prior depth is multiplied by it (scene/depth_placement.h)
  bool semantics = true;
  bool scores_as_logits = false;  ///< preset `paper`: softmax whatever the kind says
  bool exposure = false;   ///< divide the photo's light by View::log_gain, as if all photos had been exposed alike
  double score_gamma = 1;  ///< scores: max(s, 0)^gamma / sum
  double least_score_sum = kUnknownScoreSum;  ///< scores that sum to less say nothing
};

/// The photo's pixels for the view's camera: as stored where they have its size, else upright (see photo_fit.h).
/// Whoever pairs pixels with the camera reads them here.
Image<uint8_t> read_view_photo(const View& view);
/// The view's mask (photo_mask.h) for these pixels, at width x height; the view has one.
Image<uint8_t> read_view_mask(const View& view, int width, int height);

/// Divides a photo's linear light by the exponentials of `log_gain`, one per channel. `color`: H x W x 3, sRGB in [0,
/// 1].
void divide_exposure(const Vec3f& log_gain, ImageF& color);

/// Loads one view. Maps smaller or larger than the image are sampled at pixel centres with the half-pixel
/// rule: source coordinate (x + 0.5) * source_width / width - 0.5.
/// Throws Error{kBadInput} naming the file, the field and the remedy.
ViewData load_view(const Scene& scene, int view, const LoadOptions& options = {});

/// True depth in metres; 0 = none. Metres are the units of truth/sparse and, when the scene is metric, of the scene.
/// Resized (nearest) to the given camera's size.
ImageF load_truth_depth(const Scene& scene, int view, const Camera& camera);
/// True labels, kNoLabel = none; resized (nearest) to the given camera's size.
Image<uint16_t> load_truth_labels(const Scene& scene, int view, const Camera& camera);

/// Opens and checks every file of every view, training and test. Returns one message per problem found, each naming
/// file, field and remedy; empty without problems. `train` calls this before its first step.
struct SceneProblem {
  std::filesystem::path path;
  std::string field, message, remedy;
  bool fatal = true;   ///< false: a warning (for `aligngs data check`)
  std::string view{};  ///< the view that it concerns; empty: the scene
};
std::vector<SceneProblem> check_scene(const Scene& scene);

/// Takes the views with a fatal problem out of the lists, into scene.left_out. Returns the remaining problems: warnings
/// and those of the scene as a whole. Error{kBadInput} when too few training views remain.
std::vector<SceneProblem> leave_out_bad_views(Scene& scene, const std::vector<SceneProblem>& problems);
/// The same for views that were found out before, by name.
void leave_out_views(Scene& scene, const std::vector<std::string>& names);

}  // namespace aligngs
