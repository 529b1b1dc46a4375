#include "scene/import/view_selection.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "core/median.h"
#include "scene/image_quality.h"
#include "scene/lens_model.h"
#include "scene/photo_fit.h"

namespace aligngs {
namespace {

constexpr int kGridColumns = 8, kGridRows = 6;  // rays per frame that become surface samples
constexpr double kCosSameDirection = 0.99939;   // 2 degrees: less parallax adds no depth
constexpr double kGain[3] = {1, 0.5, 0.25};     // value of the first, second, third view of a sample
constexpr double kOcclusionSlack = 0.05;        // relative depth difference that still counts as seen

struct SurfaceSample {
  Vec3d position;
  int seen = 0;
  Vec3d directions[3];
};

struct PinholeView {
  double fx, fy, cx, cy, width, height;
  Rigidd pose;
  Vec3d centre;
};

PinholeView pinhole_view(const CapturedFrame& frame) {
  const Camera c = lens_of(frame.camera, frame.image).pinhole();
  return {c.fx,
          c.fy,
          c.cx,
          c.cy,
          double(c.width),
          double(c.height),
          frame.world_to_camera,
          frame.world_to_camera.inverse().translation};
}

constexpr double kUnreadable = -1;  // sharpness of a photo that cannot be decoded

double sharpness_of(const CapturedFrame& frame, int width) {
  try {
    return sharpness(read_photo(frame.image, frame.upright), width);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kBadInput) throw;
    return kUnreadable;
  }
}

/// Empty when the frame has no depth, or none that can be read: then it is left out later, with its reason.
ImageF depth_of(const Capture& capture, const CapturedFrame& frame) {
  try {
    return read_capture_depth(capture, frame);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kBadInput) throw;
    return {};
  }
}

/// Sharp frames: in each window of consecutive frames the blurriest share is left out.
std::vector<int> sharp_candidates(const std::vector<double>& scores, const ViewSelectionOptions& options) {
  constexpr int kWindow = 9;  // frames: about a third of a second of video, in which the scene hardly changes
  std::vector<int> kept;
  const int n = static_cast<int>(scores.size());
  for (int i = 0; i < n; ++i) {
    if (scores[i] == kUnreadable) continue;
    const int low = std::max(0, i - kWindow / 2), high = std::min(n, low + kWindow);
    int sharper_than = 0;
    for (int j = low; j < high; ++j) sharper_than += scores[j] < scores[i];
    if (high - low < 3 || sharper_than >= options.blurry_share * (high - low) - 1) kept.push_back(i);
  }
  while (static_cast<int>(kept.size()) > options.max_candidates) {  // thin evenly, keeping the ends
    std::vector<int> thinned;
    for (int i = 0; i < options.max_candidates; ++i) {
      thinned.push_back(kept[size_t(i) * (kept.size() - 1) / std::max(1, options.max_candidates - 1)]);
    }
    kept = thinned;
  }
  return kept;
}

std::vector<double> sharpness_of_frames(const Capture& capture, const std::vector<int>& frames, ThreadPool& pool) {
  uint64_t narrowest = kSharpnessWidth;
  for (const int i : frames) narrowest = std::min(narrowest, capture.frames[i].camera.width);
  const int width = static_cast<int>(narrowest);
  std::vector<double> scores(frames.size());
  pool.parallel_for(scores.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) scores[i] = sharpness_of(capture.frames[frames[i]], width);
  });
  return scores;
}

std::vector<SurfaceSample> samples_of_frame(const Capture& capture, const CapturedFrame& frame, double fallback_depth) {
  const PinholeView view = pinhole_view(frame);
  const Rigidd to_world = view.pose.inverse();
  const ImageF depth = depth_of(capture, frame);
  std::vector<SurfaceSample> samples;
  for (int r = 0; r < kGridRows; ++r) {
    for (int c = 0; c < kGridColumns; ++c) {
      const double u = (c + 0.5) / kGridColumns, v = (r + 0.5) / kGridRows;
      const Vec3d ray{(u * view.width - view.cx) / view.fx, (v * view.height - view.cy) / view.fy, 1};
      if (depth.empty()) {
        for (const double share : {0.5, 1.0, 1.6})
          samples.push_back({to_world * (ray * (fallback_depth * share)), 0, {}});
      } else {
        const double z = depth.at(static_cast<int>(u * depth.width), static_cast<int>(v * depth.height));
        if (z > 0) samples.push_back({to_world * (ray * z), 0, {}});
      }
    }
  }
  return samples;
}

/// A typical viewing distance: to the cloud when there is one, 2.5 m in a metric capture, else 1.5 times the camera
/// spread.
double typical_depth(const Capture& capture, const std::vector<PinholeView>& views) {
  std::vector<double> distances;
  const size_t step = std::max<size_t>(1, capture.cloud.size() / 2000);
  for (size_t i = 0; i < capture.cloud.size(); i += step) {
    for (size_t v = 0; v < views.size(); v += std::max<size_t>(1, views.size() / 8)) {
      const Vec3d p = views[v].pose * capture.cloud.positions[i];
      if (p.z > 0) distances.push_back(p.z);
    }
  }
  if (!distances.empty()) return median_of(std::move(distances));
  if (capture.metric) return 2.5;  // metres: half a room
  double spread = 0;
  for (const PinholeView& v : views) spread = std::max(spread, norm(v.centre - views[0].centre));
  return spread > 0 ? 1.5 * spread : 1;
}

/// Small depth map on the sample grid, to leave out samples that something nearer hides.
struct CoarseDepth {
  ImageF map;
  bool hides(double u, double v, double z) const {
    if (map.empty()) return false;
    const float d = map.at(static_cast<int>(u * map.width), static_cast<int>(v * map.height));
    return d > 0 && z > d * (1 + kOcclusionSlack);
  }
};

CoarseDepth coarse_depth(const Capture& capture, const CapturedFrame& frame) {
  CoarseDepth coarse;
  const ImageF depth = depth_of(capture, frame);
  if (depth.empty()) return coarse;
  coarse.map = ImageF(64, 48, 1, 0.f);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x)
      coarse.map.at(x, y) = depth.at((2 * x + 1) * depth.width / 128, (2 * y + 1) * depth.height / 96);
  }
  return coarse;
}

}  // namespace

std::vector<int> select_views(const Capture& capture, const ViewSelectionOptions& options, ThreadPool& pool) {
  if (options.count < 1) throw_usage("--views needs at least one view");
  const int n = static_cast<int>(capture.frames.size());
  std::vector<int> all(n);
  std::iota(all.begin(), all.end(), 0);
  if (options.count >= n) return all;

  std::vector<int> candidates = sharp_candidates(sharpness_of_frames(capture, all, pool), options);
  // what cannot be read is left out by the import
  if (static_cast<int>(candidates.size()) < options.count) candidates = all;
  const int m = static_cast<int>(candidates.size());
  std::vector<PinholeView> views;
  for (const int i : candidates) views.push_back(pinhole_view(capture.frames[i]));
  const double fallback = typical_depth(capture, views);

  std::vector<std::vector<SurfaceSample>> parts(m);
  std::vector<CoarseDepth> depths(m);
  pool.parallel_for(m, 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      parts[i] = samples_of_frame(capture, capture.frames[candidates[i]], fallback);
      depths[i] = coarse_depth(capture, capture.frames[candidates[i]]);
    }
  });
  std::vector<SurfaceSample> samples;
  for (const auto& part : parts) samples.insert(samples.end(), part.begin(), part.end());

  // Samples that each candidate sees, once.
  std::vector<std::vector<uint32_t>> sees(m);
  pool.parallel_for(m, 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const PinholeView& view = views[i];
      for (uint32_t s = 0; s < samples.size(); ++s) {
        const Vec3d p = view.pose * samples[s].position;
        if (!(p.z > 0)) continue;
        const double u = (view.fx * p.x / p.z + view.cx) / view.width,
                     v = (view.fy * p.y / p.z + view.cy) / view.height;
        if (u >= 0 && v >= 0 && u < 1 && v < 1 && !depths[i].hides(u, v, p.z)) sees[i].push_back(s);
      }
    }
  });

  std::vector<uint8_t> used(m, 0);
  std::vector<int> chosen;
  while (static_cast<int>(chosen.size()) < options.count) {
    std::vector<double> gains(m, -1);
    pool.parallel_for(m, 4, [&](size_t begin, size_t end, int) {
      for (size_t i = begin; i < end; ++i) {
        if (used[i]) continue;
        double gain = 0;
        for (const uint32_t s : sees[i]) {
          const SurfaceSample& sample = samples[s];
          if (sample.seen >= 3) continue;
          const Vec3d direction = normalized(sample.position - views[i].centre);
          bool repeated = false;
          for (int k = 0; k < sample.seen; ++k)
            repeated = repeated || dot(direction, sample.directions[k]) > kCosSameDirection;
          if (!repeated) gain += kGain[sample.seen];
        }
        gains[i] = gain;
      }
    });
    const int best = static_cast<int>(std::max_element(gains.begin(), gains.end()) - gains.begin());
    used[best] = 1;
    chosen.push_back(candidates[best]);
    for (const uint32_t s : sees[best]) {
      SurfaceSample& sample = samples[s];
      if (sample.seen < 3) sample.directions[sample.seen++] = normalized(sample.position - views[best].centre);
    }
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

std::vector<int> select_stride(const Capture& capture, int stride) {
  if (stride < 1) throw_usage("--stride needs a positive number");
  std::vector<int> chosen;
  for (size_t i = 0; i < capture.frames.size(); i += static_cast<size_t>(stride)) chosen.push_back(static_cast<int>(i));
  return chosen;
}

std::vector<int> select_test_views(const Capture& capture, const std::vector<int>& train, int count, ThreadPool& pool) {
  const int n = static_cast<int>(capture.frames.size());
  std::vector<uint8_t> is_train(n, 0);
  for (const int i : train) is_train[i] = 1;
  std::vector<int> far, near;  // not adjacent to a training frame, and adjacent
  for (int i = 0; i < n; ++i) {
    if (is_train[i]) continue;
    const bool adjacent = (i > 0 && is_train[i - 1]) || (i + 1 < n && is_train[i + 1]);
    (adjacent ? near : far).push_back(i);
  }
  std::vector<int> all(far);
  all.insert(all.end(), near.begin(), near.end());
  std::sort(all.begin(), all.end());
  const auto are_enough = [count](const std::vector<int>& frames) { return static_cast<int>(frames.size()) >= count; };
  const std::vector<int>& source = are_enough(far) ? far : are_enough(near) ? near : all;
  std::vector<int> chosen;
  const int wanted = std::min<int>(count, static_cast<int>(source.size()));
  const std::vector<double> scores = sharpness_of_frames(capture, source, pool);
  for (int k = 0; k < wanted; ++k) {  // the sharpest of each of `wanted` equal stretches
    const size_t low = source.size() * k / wanted, high = source.size() * (k + 1) / wanted;
    size_t best = low;
    for (size_t i = low; i < high; ++i) {
      if (scores[i] > scores[best]) best = i;
    }
    chosen.push_back(source[best]);
  }
  return chosen;
}

}  // namespace aligngs
