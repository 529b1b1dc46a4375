#include "scene/view_data.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/is_depth.h"
#include "core/srgb.h"
#include "io/image_file.h"
#include "io/resample.h"
#include "scene/ignored_classes.h"
#include "scene/photo_fit.h"
#include "scene/photo_mask.h"
#include "scene/prior_maps.h"
#include "scene/semantic_target.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr float kMetresPerUnit = 0.001f;  ///< truth/depth holds millimetres
constexpr uint16_t kNoTruthLabel = 255;   ///< in truth/labels

const View& view_at(const Scene& scene, int view) {
  if (view < 0 || view >= static_cast<int>(scene.views.size())) {
    throw Error({ErrorKind::kFailed, "no view " + std::to_string(view), scene.folder, "view", {}});
  }
  return scene.views[view];
}

int scaled(int side, double scale) { return std::max(1, static_cast<int>(std::lround(side * scale))); }

/// Colour and mask at the size of data.camera.
void load_image(const View& view, ViewData& data) {
  const Image<uint8_t> bytes = read_view_photo(view);
  if (bytes.width != view.camera.width || bytes.height != view.camera.height) {
    throw_bad_input(view.image, "size",
                    std::to_string(bytes.width) + " x " + std::to_string(bytes.height) + ", but its camera has " +
                        std::to_string(view.camera.width) + " x " + std::to_string(view.camera.height),
                    "use the images that the camera model was made from");
  }
  ImageF color(bytes.width, bytes.height, 3);
  const bool has_alpha = bytes.channels == 4;
  ImageF alpha(has_alpha ? bytes.width : 0, has_alpha ? bytes.height : 0, 1);
  for (size_t i = 0; i < bytes.pixels(); ++i) {
    const uint8_t* pixel = &bytes.data[i * bytes.channels];
    for (int c = 0; c < 3; ++c) color.data[3 * i + c] = static_cast<float>(pixel[c]) / 255.0f;
    if (has_alpha) alpha.data[i] = static_cast<float>(pixel[3]) / 255.0f;
  }
  const Camera& camera = data.camera;
  const bool resize = camera.width != bytes.width || camera.height != bytes.height;
  data.color = resize ? resize_area(color, camera.width, camera.height) : std::move(color);
  if (!has_alpha) return;
  data.mask = resize ? resize_area(alpha, camera.width, camera.height) : std::move(alpha);
  for (float& m : data.mask.data) m = m >= 0.5f ? 1.0f : 0.0f;
}

void load_depth(const View& view, double factor, ViewData& data) {
  FloatArray array = read_map(view.prior_depth);
  const MapShape shape = depth_map_shape(array.shape, view.prior_depth);
  require_same_aspect(shape, view.camera.width, view.camera.height, view.prior_depth, "shape");
  ImageF depth;
  depth.width = shape.width;
  depth.height = shape.height;
  depth.channels = 1;
  depth.data = std::move(array.data);
  for (float& z : depth.data) {
    z = is_depth(z) ? z * static_cast<float>(factor) : 0.0f;
  }
  const bool resize = data.camera.width != depth.width || data.camera.height != depth.height;
  data.prior_depth = resize ? resize_depth(depth, data.camera.width, data.camera.height) : std::move(depth);
}

void load_semantics(const Scene& scene, const View& view, const LoadOptions& options, ViewData& data) {
  const FloatArray array = read_map(view.semantics);
  const MapShape shape = semantic_map_shape(array.shape, scene.labels.size(), view.semantics);
  require_same_aspect(shape, view.camera.width, view.camera.height, view.semantics, "shape");
  SemanticConversion conversion;
  conversion.kind = options.scores_as_logits ? SemanticKind::kLogits : scene.semantic_kind;
  conversion.score_gamma = options.score_gamma;
  conversion.least_score_sum = options.least_score_sum;
  data.semantics = semantic_target(array.data.data(), shape.channels, shape.width, shape.height, conversion);
  data.labels = target_labels(data.semantics, data.camera.width, data.camera.height);
}

/// A truth map of the view's aspect.
Image<uint16_t> read_truth(const View& view, const std::filesystem::path& path, const char* what) {
  if (path.empty()) {
    throw Error({ErrorKind::kFailed, "view " + view.name + " has no true " + what, {}, what, {}});
  }
  Image<uint16_t> map = read_gray_png(path);
  require_same_aspect({1, map.height, map.width}, view.camera.width, view.camera.height, path, "size");
  return map;
}

void hide(const Image<uint8_t>& mask, ViewData& data) {
  if (data.mask.empty()) data.mask = ImageF(mask.width, mask.height, 1, 1.0f);
  for (size_t i = 0; i < mask.data.size(); ++i) {
    if (mask.data[i] == 0) data.mask.data[i] = 0;
  }
}

/// Leaves out of the view what masks/ and ignored classes hide.
void apply_masks(const Scene& scene, const View& view, const LoadOptions& options, ViewData& data) {
  const int width = data.camera.width, height = data.camera.height;
  if (!view.mask.empty()) hide(read_view_mask(view, width, height), data);
  if (!scene.ignored.empty() && !view.semantics.empty()) {
    ViewData labelled;
    if (data.semantics.empty()) load_semantics(scene, view, options, labelled);
    hide(mask_without(data.semantics.empty() ? labelled.labels : data.labels, scene.ignored), data);
  }
  if (data.mask.empty() || data.prior_depth.empty()) return;
  for (size_t i = 0; i < data.mask.data.size(); ++i) {
    if (!(data.mask.data[i] > 0.5f)) data.prior_depth.data[i] = 0;
  }
}

}  // namespace

Image<uint8_t> read_view_photo(const View& view) {
  return read_photo_of_size(view.image, view.camera.width, view.camera.height);
}

Image<uint8_t> read_view_mask(const View& view, int width, int height) {
  return read_mask(view.mask, view.image,
                   is_upright_of_size(read_image_info(view.image), view.camera.width, view.camera.height), width,
                   height);
}

void divide_exposure(const Vec3f& log_gain, ImageF& color) {
  // of the tone curve, between which it is straight: errors are below 1e-4, a 40th of an 8-bit step
  constexpr int kSteps = 1024;
  for (int k = 0; k < 3; ++k) {
    if (log_gain[k] == 0) continue;
    float curve[kSteps + 2];
    const float factor = std::exp(-log_gain[k]);
    for (int i = 0; i < kSteps + 2; ++i) curve[i] = srgb_encode(factor * srgb_decode(static_cast<float>(i) / kSteps));
    for (size_t i = static_cast<size_t>(k); i < color.data.size(); i += 3) {
      const float at = std::min(std::max(color.data[i], 0.0f), 1.0f) * kSteps;
      const int step = static_cast<int>(at);
      const float share = at - static_cast<float>(step);
      color.data[i] = (1 - share) * curve[step] + share * curve[step + 1];
    }
  }
}

ViewData load_view(const Scene& scene, int view, const LoadOptions& options) {
  const View& source = view_at(scene, view);
  if (!(options.scale > 0 && options.scale <= 1)) {
    throw Error({ErrorKind::kFailed, "must lie in (0, 1]", {}, "scale", {}});
  }
  ViewData data;
  data.name = source.name;
  data.camera =
      source.camera.resized(scaled(source.camera.width, options.scale), scaled(source.camera.height, options.scale));
  load_image(source, data);
  if (options.exposure) divide_exposure(source.log_gain, data.color);
  if (options.prior_depth && !source.prior_depth.empty()) load_depth(source, options.depth_factor, data);
  if (options.semantics && !source.semantics.empty()) load_semantics(scene, source, options, data);
  apply_masks(scene, source, options, data);
  return data;
}

ImageF load_truth_depth(const Scene& scene, int view, const Camera& camera) {
  const View& source = view_at(scene, view);
  const Image<uint16_t> millimetres =
      resize_nearest(read_truth(source, source.truth_depth, "depth"), camera.width, camera.height);
  ImageF depth(camera.width, camera.height, 1);
  for (size_t i = 0; i < depth.data.size(); ++i) {
    depth.data[i] = static_cast<float>(millimetres.data[i]) * kMetresPerUnit;
  }
  return depth;
}

Image<uint16_t> load_truth_labels(const Scene& scene, int view, const Camera& camera) {
  const View& source = view_at(scene, view);
  Image<uint16_t> labels =
      resize_nearest(read_truth(source, source.truth_labels, "labels"), camera.width, camera.height);
  for (uint16_t& label : labels.data) {
    if (label == kNoTruthLabel) label = kNoLabel;
    if (label != kNoLabel && label >= scene.labels.size()) {
      throw_bad_input(source.truth_labels, "pixels",
                      "label " + std::to_string(label) + " is no class of the " + std::to_string(scene.labels.size()) +
                          " of the label set",
                      "write 255 for pixels without a label");
    }
  }
  return labels;
}

}  // namespace aligngs
