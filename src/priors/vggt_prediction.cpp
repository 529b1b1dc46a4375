#include "priors/vggt_prediction.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "core/error.h"
#include "core/median.h"
#include "io/image_file.h"
#include "scene/photo_fit.h"

namespace aligngs {
namespace {

/// Fields of view that a photograph can have, radians: a long telephoto lens, an ultra-wide one.
constexpr double kNarrowest = 2 * kPi / 180, kWidest = 160 * kPi / 180;

double field_of_view(double focal, double side) { return 2 * std::atan2(side / 2, focal); }

bool plausible(const nn::VggtCamera& camera) {
  for (const double v : camera.rotation) {
    if (!std::isfinite(v)) return false;
  }
  for (const double v : camera.translation) {
    if (!std::isfinite(v)) return false;
  }
  // A field of view of half a turn or more gives a focal length that is not positive.
  const auto good = [](double focal, double centre) {
    if (!(focal > 0) || !std::isfinite(focal)) return false;
    const double angle = field_of_view(focal, 2 * centre);
    return angle >= kNarrowest && angle <= kWidest;
  };
  return good(camera.fx, camera.cx) && good(camera.fy, camera.cy);
}

nn::FeatureMap unit_image(const Image<uint8_t>& image) {
  nn::FeatureMap map(image.height, image.width, 3);
  for (size_t i = 0; i < image.data.size(); ++i) map.data[i] = float(image.data[i]) / 255.f;
  return map;
}

}  // namespace

VggtInputs vggt_inputs(const std::vector<Photo>& photos, ThreadPool& pool) {
  bool all_landscape = true;
  for (const Photo& photo : photos) all_landscape = all_landscape && photo.width >= photo.height;
  const nn::VggtFit fit = all_landscape ? nn::VggtFit::kCrop : nn::VggtFit::kPad;
  VggtInputs inputs;
  inputs.images.resize(photos.size());
  inputs.placements.resize(photos.size());
  pool.parallel_for(photos.size(), 1, [&](size_t i, size_t, int) {
    inputs.images[i] = nn::vggt_image(read_photo_of_size(photos[i].file, photos[i].width, photos[i].height), fit, &inputs.placements[i]);
  });
  nn::vggt_common_size(inputs.images, &inputs.placements);
  return inputs;
}

void add_vggt_memory(MemoryBudget& budget, const nn::Weights& weights, nn::Precision precision,
                     size_t frames, int width, int height) {
  const uint64_t matrix_bytes = precision == nn::Precision::kBfloat16 ? 2 : 4;
  uint64_t weight_bytes = 0;
  for (const std::string& name : weights.names()) {
    if (name.rfind("track_head.", 0) == 0) continue;
    uint64_t count = 1;
    for (const int64_t n : weights.shape(name)) count *= uint64_t(n);
    weight_bytes += count * (name.rfind("camera_head.", 0) == 0 ? 4 : matrix_bytes);
  }
  budget.add("weights of the network", weight_bytes);
  const auto channels = uint64_t(weights.dimension("aggregator.camera_token", 3));
  const auto registers = uint64_t(weights.dimension("aggregator.register_token", 2));
  const uint64_t patches = uint64_t(width / nn::kVggtPatch) * uint64_t(height / nn::kVggtPatch);
  const uint64_t tokens = frames * (patches + 1 + registers);
  constexpr uint64_t kKept = 4, kStream = 3;  // layers for the dense heads; copies of the stream
  budget.add("tokens kept for the dense heads", kKept * tokens * 2 * channels * 4);
  // The heads begin when the tokens are done: the larger of the two counts.
  const uint64_t in_work = tokens * channels * (kStream * 4 + 3 * matrix_bytes + 4);
  constexpr uint64_t kDensePerPixel = 2200;  // bytes: the widest maps of a dense head
  const uint64_t dense = kDensePerPixel * uint64_t(width) * uint64_t(height);
  budget.add(in_work > dense ? "tokens in work" : "one frame in the dense head",
             std::max(in_work, dense));
  constexpr uint64_t kMapsPerPixel = 12 + 12 + 8;  // input, its copy, depth and confidence
  budget.add("photos and their maps", frames * kMapsPerPixel * uint64_t(width) * uint64_t(height));
}

Camera camera_of_photo(const nn::VggtCamera& predicted, const nn::VggtPlacement& placement,
                       int width, int height) {
  // Pixel i of the photo covers [i, i + 1); u = x * scale + offset holds for such coordinates, and
  // the network's principal point is the middle of its input.
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = predicted.fx / placement.scale_x;
  camera.fy = predicted.fy / placement.scale_y;
  camera.cx = (predicted.cx - placement.offset_x) / placement.scale_x;
  camera.cy = (predicted.cy - placement.offset_y) / placement.scale_y;
  for (int i = 0; i < 9; ++i) camera.world_to_camera.rotation.m[i] = predicted.rotation[size_t(i)];
  const auto& t = predicted.translation;
  camera.world_to_camera.translation = {t[0], t[1], t[2]};
  return camera;
}

PhotoMaps maps_of_photo(const nn::FeatureMap& depth, const nn::VggtPlacement& placement, int width,
                        int height) {
  constexpr float kJump = 0.05f;  // relative step of depth that separates surfaces
  const double part_width = width * placement.scale_x, part_height = height * placement.scale_y;
  const double scale = std::max(part_width, part_height) / std::max(width, height);
  const int w = std::max(1, int(width * scale + 0.5)), h = std::max(1, int(height * scale + 0.5));
  PhotoMaps maps{ImageF(w, h, 1), ImageF(w, h, 1)};
  const auto valid = [](float z) { return std::isfinite(z) && z > 0; };
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const double u = (x + 0.5) * width / w * placement.scale_x + placement.offset_x;
      const double v = (y + 0.5) * height / h * placement.scale_y + placement.offset_y;
      if (u < 0 || v < 0 || u >= double(depth.width) || v >= double(depth.height)) continue;
      const auto nearest_x = int64_t(u), nearest_y = int64_t(v);
      const float nearest = depth.at(nearest_y, nearest_x)[0];
      if (!valid(nearest)) continue;
      const double left = std::clamp(u - 0.5, 0.0, double(depth.width - 1));
      const double top = std::clamp(v - 0.5, 0.0, double(depth.height - 1));
      const auto x0 = int64_t(left), y0 = int64_t(top);
      const int64_t x1 = std::min(x0 + 1, depth.width - 1), y1 = std::min(y0 + 1, depth.height - 1);
      const float fx = float(left - double(x0)), fy = float(top - double(y0));
      const float weights[4] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
      const float* corners[4] = {depth.at(y0, x0), depth.at(y0, x1), depth.at(y1, x0),
                                 depth.at(y1, x1)};
      float z = 0, confidence = 0;
      bool one_surface = true;
      for (int k = 0; k < 4; ++k) {
        one_surface = one_surface && valid(corners[k][0]) &&
                      std::abs(corners[k][0] - nearest) <= kJump * nearest;
        z += weights[k] * corners[k][0];
        confidence += weights[k] * corners[k][1];
      }
      maps.depth.at(x, y) = one_surface ? z : nearest;
      maps.confidence.at(x, y) = one_surface ? confidence : depth.at(nearest_y, nearest_x)[1];
    }
  }
  return maps;
}

std::vector<VggtView> predict_vggt_views(nn::Compute& compute, const nn::Vggt& network,
                                         const std::vector<Photo>& photos, VggtInputs inputs,
                                         const VggtPredictionOptions& options) {
  std::vector<nn::FeatureMap> images;
  for (Image<uint8_t>& image : inputs.images) {
    images.push_back(unit_image(image));
    image = {};
  }
  std::vector<VggtView> views(photos.size());
  Progress progress(options.progress, "VGGT", photos.size());
  network(compute, std::move(images), {true, false}, [&](int64_t frame, nn::VggtFrame predicted) {
    const auto i = size_t(frame);
    const Photo& photo = photos[i];
    if (!plausible(predicted.camera)) {
      throw Error({ErrorKind::kFailed, "the network predicts an impossible camera for this photo",
                   photo.file, "field of view",
                   "leave the photo out, or use --method colmap; check the weights with `aligngs "
                   "models verify`"});
    }
    VggtView& view = views[i];
    view.camera = camera_of_photo(predicted.camera, inputs.placements[i], photo.width, photo.height);
    PhotoMaps maps = maps_of_photo(predicted.depth, inputs.placements[i], photo.width, photo.height);
    view.depth = std::move(maps.depth);
    view.confidence = std::move(maps.confidence);
    progress.update(i + 1);
  });
  // The first camera is predicted near the identity, not on it.
  const Rigidd to_first = views[0].camera.world_to_camera.inverse();
  for (VggtView& view : views) view.camera.world_to_camera = view.camera.world_to_camera * to_first;
  if (options.shared_focal) {
    std::vector<double> relative;  // to the longer side, so that photos turned upright agree
    for (const VggtView& view : views) {
      relative.push_back((view.camera.fx + view.camera.fy) / 2 /
                         std::max(view.camera.width, view.camera.height));
    }
    const double median = double(float(median_of(relative)));
    for (VggtView& view : views) {
      view.camera.fx = view.camera.fy =
          median * std::max(view.camera.width, view.camera.height);
    }
  }
  return views;
}

float confidence_at(const std::vector<VggtView>& views, double percent) {
  std::vector<float> values;
  for (const VggtView& view : views) {
    for (const float c : view.confidence.data) {
      if (c > 0 && std::isfinite(c)) values.push_back(c);
    }
  }
  if (values.empty()) return 0;
  const size_t rank =
      std::min(values.size() - 1, size_t(double(values.size()) * std::clamp(percent, 0.0, 100.0) / 100));
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(rank), values.end());
  return values[rank];
}

}  // namespace aligngs
