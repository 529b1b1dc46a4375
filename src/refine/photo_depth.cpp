#include "refine/photo_depth.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/median.h"
#include "io/resample.h"

namespace aligngs {
namespace {

constexpr size_t kLeastPoints = 8;    // fewer do not tell how near and how far a photo sees
constexpr double kStrayShare = 0.02;  // of the points, at either end: wrong ones lie anywhere
// weight of a photo's usual depth where nothing is measured within some 1000 pixels
constexpr double kNoDepth = 1e-6;
constexpr double kPassesOfSearch = 3;  // the search over all depths takes about as long as so many passes of its size

struct DepthRange {
  double nearest, farthest;
};

std::optional<DepthRange> range_of(const Camera& camera, const std::vector<Vec3f>& points) {
  std::vector<double> depths;
  for (const Vec3f& point : points) {
    const Vec3d p = camera.world_to_camera * point.cast<double>();
    if (p.z > 0 && camera.contains(camera.project(p))) depths.push_back(p.z);
  }
  if (depths.size() < kLeastPoints) return std::nullopt;
  std::sort(depths.begin(), depths.end());
  const size_t stray = static_cast<size_t>(kStrayShare * static_cast<double>(depths.size()));
  return DepthRange{depths[stray], depths[depths.size() - 1 - stray]};
}

/// Range of every photo; all alike (0, 0) when there are too few points for any.
std::vector<DepthRange> ranges_of(const std::vector<MatchView>& views, const std::vector<Vec3f>& points) {
  std::vector<std::optional<DepthRange>> own;
  std::vector<double> nearest, farthest;
  for (const MatchView& view : views) {
    own.push_back(range_of(view.camera, points));
    if (!own.back()) continue;
    nearest.push_back(own.back()->nearest);
    farthest.push_back(own.back()->farthest);
  }
  const DepthRange usual{median_of(std::move(nearest)), median_of(std::move(farthest))};
  std::vector<DepthRange> ranges;
  for (const auto& range : own) ranges.push_back(range.value_or(usual));
  return ranges;
}

class Search {
 public:
  Search(const std::vector<MatchView>& views, const PhotoDepthSettings& settings, ThreadPool& pool,
         const std::function<void(double share)>& progress)
      : originals_(views), settings_(settings), pool_(pool), progress_(progress) {
    for (const MatchView& view : views) {
      const int width = std::min(settings.coarse_width, view.camera.width);
      const int height = std::max(1, (view.camera.height * width + view.camera.width / 2) / view.camera.width);
      photos_.push_back({view.camera.resized(width, height), resize_area(view.luma, width, height), {}});
      pixels_ += static_cast<double>(width) * height;
      fine_pixels_ += static_cast<double>(view.luma.pixels());
    }
    all_work_ = pixels_ * (kPassesOfSearch + settings.coarse_passes) + fine_pixels_ * settings.fine_passes;
  }

  /// Over all depths, around one depth per photo.
  void over(const std::vector<DepthRange>& ranges) {
    StereoSettings stereo = settings_.stereo;
    stereo.sweep.range = 0;
    for (size_t i = 0; i < photos_.size(); ++i) {
      const DepthRange& r = ranges[i];
      if (!(r.nearest > 0)) continue;
      photos_[i].depth = ImageF(photos_[i].luma.width, photos_[i].luma.height, 1,
                                static_cast<float>(std::sqrt(r.nearest * r.farthest)));
      stereo.sweep.range =
          std::max(stereo.sweep.range, 0.5 * std::log(r.farthest / r.nearest) + std::log(settings_.margin));
    }
    const int steps = static_cast<int>(std::ceil(stereo.sweep.range / settings_.step));
    stereo.sweep.hypotheses = std::min(2 * steps + 1, settings_.most_hypotheses);
    stereo.sigma = settings_.coarse_sigma;
    stereo.agreement = settings_.coarse_agreement;
    near(stereo, kPassesOfSearch * pixels_);
  }

  void near(const StereoSettings& stereo, double work) {
    std::vector<const MatchView*> pointers;
    for (const MatchView& photo : photos_) pointers.push_back(&photo);
    const auto report = [&](double share) {
      if (progress_) progress_((work_done_ + share * work) / all_work_);
    };
    results_ = guided_stereo(pointers, stereo, pool_, report);
    work_done_ += work;
    pool_.parallel_for(photos_.size(), 1, [&](size_t begin, size_t end, int) {
      for (size_t i = begin; i < end; ++i) {
        if (results_[i].measured > 0)
          interpolate(photos_[i], results_[i], stereo.spread);
        else
          photos_[i].depth = {};  // alone: one depth for all of a photo is no depth
      }
    });
  }

  /// The photo's depth from what this pass measured alone: what an earlier one took for depth and nothing confirms now
  /// is forgotten.
  static void interpolate(MatchView& photo, const StereoResult& result, LogCorrectionSettings spread) {
    const ImageF& depth = photo.depth;
    ImageF given(depth.width, depth.height, 1);
    double sum = 0, weights = 0;
    for (size_t p = 0; p < given.data.size(); ++p) {
      if (result.certainty.data[p] <= 0) continue;
      given.data[p] = std::log(depth.data[p]) + result.own_factor.data[p];
      sum += static_cast<double>(result.certainty.data[p]) * given.data[p];
      weights += result.certainty.data[p];
    }
    const float usual = static_cast<float>(sum / weights);
    for (float& g : given.data) g -= usual;
    spread.none = kNoDepth;
    photo.depth = spread_log_correction(depth, given, result.certainty, spread, photo.luma);
    for (float& z : photo.depth.data) z = std::exp(usual + z);
  }

  /// To the photos' own size.
  void refine() {
    for (size_t i = 0; i < photos_.size(); ++i) {
      MatchView photo = originals_[i];
      photo.depth = {};
      if (!photos_[i].depth.empty())
        photo.depth = resize_bilinear(photos_[i].depth, photo.luma.width, photo.luma.height);
      photos_[i] = std::move(photo);
    }
  }

  std::vector<PhotoDepth> run(const std::vector<DepthRange>& ranges) {
    over(ranges);
    for (int pass = 0; pass < settings_.coarse_passes; ++pass) near(settings_.stereo, pixels_);
    if (settings_.fine_passes > 0) refine();
    for (int pass = 0; pass < settings_.fine_passes; ++pass) near(settings_.stereo, fine_pixels_);
    std::vector<PhotoDepth> out(photos_.size());
    for (size_t i = 0; i < photos_.size(); ++i) {
      if (photos_[i].depth.empty()) continue;
      const MatchView& original = originals_[i];
      out[i].measured = results_[i].measured;
      out[i].depth = std::move(photos_[i].depth);
      out[i].certainty = std::move(results_[i].certainty);
      if (settings_.fine_passes > 0) continue;
      out[i].depth = resize_bilinear(out[i].depth, original.luma.width, original.luma.height);
      out[i].certainty = resize_nearest(out[i].certainty, original.luma.width, original.luma.height);
    }
    return out;
  }

 private:
  const std::vector<MatchView>& originals_;
  const PhotoDepthSettings& settings_;
  ThreadPool& pool_;
  const std::function<void(double share)>& progress_;
  std::vector<MatchView> photos_;  ///< at the size of the pass, with the depth found so far
  std::vector<StereoResult> results_;
  double pixels_ = 0, fine_pixels_ = 0, work_done_ = 0, all_work_ = 0;
};

}  // namespace

void move_depth(const ImageF& given, const ImageF& weight, const LogCorrectionSettings& spread, const ImageF& luma,
                PhotoDepth& photo) {
  const ImageF factor = spread_log_correction(photo.depth, given, weight, spread, luma);
  for (size_t p = 0; p < factor.data.size(); ++p) photo.depth.data[p] *= std::exp(factor.data[p]);
}

double share_of_pixels(const std::vector<size_t>& counts, const std::vector<PhotoDepth>& depths) {
  size_t pixels = 0, counted = 0;
  for (size_t i = 0; i < depths.size(); ++i) {
    pixels += depths[i].depth.pixels();
    counted += counts[i];
  }
  return pixels == 0 ? 0 : static_cast<double>(counted) / static_cast<double>(pixels);
}

std::vector<PhotoDepth> photo_depth(const std::vector<MatchView>& views, const std::vector<Vec3f>& points,
                                    const PhotoDepthSettings& settings, ThreadPool& pool,
                                    const std::function<void(double share)>& progress) {
  return Search(views, settings, pool, progress).run(ranges_of(views, points));
}

}  // namespace aligngs
