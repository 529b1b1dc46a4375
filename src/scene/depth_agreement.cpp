#include "scene/depth_agreement.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/median.h"
#include "io/exif_orientation.h"

namespace aligngs {
namespace {

constexpr size_t kMostViews = 24;
constexpr size_t kSamples = 2592;   // of all views together: few views have more each, since they share less
constexpr size_t kFewSamples = 50;  // fewer tell nothing
// Relative: exact depth stays below the first, noise of sensors and of tracking below the second.
constexpr double kSlight = 0.02, kContradiction = 0.06;
constexpr double kExplained = 0.3;  // of the difference as the depth is
constexpr double kHalved = 0.5;     // the same, for explanations that good depth never has: it is noise at any factor
// Views that share hardly anything as they are, and much at another factor: these samples, and as many times more.
constexpr size_t kManySamples = 200, kTimesMore = 10;
constexpr double kSurface = 0.05;  // relative: what two views of one surface differ by at most
constexpr double kSameUnit = 1.4;  // factor: two units differ by more

struct DepthSample {
  size_t view;
  Vec3d ray;  ///< camera frame, z = 1
  double depth;
};

/// At most kMostViews, evenly spread.
std::vector<size_t> chosen_views(size_t count) {
  std::vector<size_t> views;
  const size_t kept = std::min(count, kMostViews);
  for (size_t i = 0; i < kept; ++i) views.push_back(i * count / kept);
  return views;
}

std::vector<DepthSample> samples_of(size_t view, const Camera& camera, const ImageF& depth, size_t count) {
  std::vector<DepthSample> samples;
  const int rows = std::max(1, static_cast<int>(std::lround(std::sqrt(0.75 * static_cast<double>(count)))));
  const int columns = static_cast<int>(count) / rows;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int x = (2 * column + 1) * depth.width / (2 * columns), y = (2 * row + 1) * depth.height / (2 * rows);
      const double z = depth.at(x, y);
      if (z > 0) samples.push_back({view, camera.ray(x + 0.5, y + 0.5), z});
    }
  }
  return samples;
}

/// Relative differences at depth times `factor`, of all samples that another view sees.
std::vector<double> differences(const std::vector<DepthSample>& samples, const std::vector<size_t>& views,
                                std::span<const Camera> cameras, std::span<const ImageF> depths, double factor) {
  std::vector<double> all;
  for (const size_t other : views) {
    const Camera& camera = cameras[other];
    size_t from = other;
    Rigidd to_other;
    for (const DepthSample& sample : samples) {  // those of a view follow each other
      if (sample.view == other) continue;
      if (sample.view != from) to_other = camera.world_to_camera * cameras[sample.view].world_to_camera.inverse();
      from = sample.view;
      const Vec3d p = to_other * (sample.ray * (sample.depth * factor));
      if (!(p.z > 0)) continue;
      const Vec2d pixel = camera.project(p);
      if (!camera.contains(pixel)) continue;
      const double seen = depths[other].at(static_cast<int>(pixel.x), static_cast<int>(pixel.y)) * factor;
      if (seen > 0) all.push_back(std::fabs(p.z / seen - 1));
    }
  }
  return all;
}

/// A quarter of an octave apart up to 16, then powers of ten: feet, 1/4000, 1/5000 and millimetres are among them.
std::vector<double> factors() {
  std::vector<double> all;
  for (int quarter = -16; quarter <= 16; ++quarter) all.push_back(std::exp2(quarter / 4.0));
  for (const double power : {100.0, 1000.0, 10000.0}) all.insert(all.end(), {power, 1 / power});
  return all;
}

/// The cameras if their matrices were read wrongly in this way. There are several for inverted ones: of either axes. Axes
/// of the world change nothing.
std::vector<Rigidd> reread(Misreading reading, const Rigidd& world_to_camera) {
  const Rigidd turn{Mat3d{{1, 0, 0, 0, -1, 0, 0, 0, -1}}, {}};
  const Rigidd inverse = world_to_camera.inverse();
  return reading == Misreading::kAxes ? std::vector{turn * world_to_camera} : std::vector{inverse, turn * inverse};
}

/// The map if it was read wrongly in this way.
ImageF reread(Misreading reading, const Camera& camera, const ImageF& depth) {
  if (reading == Misreading::kUpsideDown) return apply_orientation(depth, 4);  // the first row is the bottom
  ImageF out = depth;
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) out.at(x, y) /= static_cast<float>(norm(camera.ray(x + 0.5, y + 0.5)));
  }
  return out;
}

/// Whether a difference explains what another contradicts: it is at most `share` of that.
bool explains(double difference, size_t samples, const DepthAgreement& as_it_is, double share) {
  const bool little_shared = as_it_is.samples < kFewSamples;
  if (little_shared)
    return samples >= kManySamples && samples >= kTimesMore * as_it_is.samples && difference < kSurface;
  const size_t enough = as_it_is.difference > kContradiction ? kFewSamples : kManySamples;
  return samples >= enough && difference < share * as_it_is.difference;
}

std::vector<DepthSample> samples_of_all(const std::vector<size_t>& views, std::span<const Camera> cameras,
                                        std::span<const ImageF> depths) {
  std::vector<DepthSample> samples;
  for (const size_t view : views) {
    const std::vector<DepthSample> of_view = samples_of(view, cameras[view], depths[view], kSamples / views.size());
    samples.insert(samples.end(), of_view.begin(), of_view.end());
  }
  return samples;
}

/// Sets the misreading of the maps that explains more than the agreement's.
void find_misread_maps(const std::vector<size_t>& views, std::span<const Camera> cameras,
                       std::span<const ImageF> depths, DepthAgreement& agreement) {
  for (const Misreading reading : {Misreading::kAlongRays, Misreading::kUpsideDown}) {
    std::vector<ImageF> read(depths.size());
    for (const size_t view : views) read[view] = reread(reading, cameras[view], depths[view]);
    const std::vector<double> all = differences(samples_of_all(views, cameras, read), views, cameras, read, 1);
    if (all.empty()) continue;
    const double difference = median_of(all);
    if (difference >= agreement.read_difference || difference >= kSurface ||
        !explains(difference, all.size(), agreement, kHalved))
      continue;
    agreement.misreading = reading;
    agreement.read_difference = difference;
  }
}

/// Sets the misreading of the matrices that explains the most.
void find_misread_poses(const std::vector<DepthSample>& samples, const std::vector<size_t>& views,
                        std::span<const Camera> cameras, std::span<const ImageF> depths, DepthAgreement& agreement) {
  for (const Misreading reading : {Misreading::kAxes, Misreading::kInverted}) {
    const size_t ways = reread(reading, Rigidd{}).size();
    for (size_t way = 0; way < ways; ++way) {
      std::vector<Camera> read(cameras.begin(), cameras.end());
      for (Camera& camera : read) camera.world_to_camera = reread(reading, camera.world_to_camera)[way];
      const std::vector<double> all = differences(samples, views, read, depths, 1);
      if (all.empty()) continue;
      const double difference = median_of(all);
      if (difference >= agreement.read_difference || difference >= kSurface ||
          !explains(difference, all.size(), agreement, kExplained))
        continue;
      agreement.misreading = reading;
      agreement.read_difference = difference;
    }
  }
}

}  // namespace

bool DepthAgreement::has_other_unit() const {
  if (std::fmax(factor, 1 / factor) < kSameUnit) return false;
  return difference > kSlight && explains(scaled_difference, scaled_samples, *this, kHalved);
}

bool DepthAgreement::is_contradicted() const {
  constexpr size_t kEnough = 500;  // samples; occlusions decide where views share less
  constexpr double kByFar = 0.12;  // relative: good depth of sensors and networks stays below 0.05
  return samples >= kEnough && difference > kByFar;
}

DepthAgreement depth_agreement(std::span<const Camera> cameras, std::span<const ImageF> depths) {
  const std::vector<size_t> views = chosen_views(cameras.size());
  const std::vector<DepthSample> samples = samples_of_all(views, cameras, depths);
  DepthAgreement agreement;
  const std::vector<double> as_it_is = differences(samples, views, cameras, depths, 1);
  agreement.samples = agreement.scaled_samples = as_it_is.size();
  agreement.difference = as_it_is.size() < kFewSamples ? 1 : median_of(as_it_is);
  agreement.scaled_difference = agreement.difference;
  if (agreement.difference <= kSlight) return agreement;
  const auto try_factor = [&](double factor) {
    const std::vector<double> scaled = differences(samples, views, cameras, depths, factor);
    if (scaled.size() < std::max(kFewSamples, as_it_is.size() / 3)) return;  // by chance, a few always agree
    if (const double difference = median_of(scaled); difference < agreement.scaled_difference) {
      agreement.scaled_difference = difference;
      agreement.scaled_samples = scaled.size();
      agreement.factor = factor;
    }
  };
  for (const double factor : factors()) try_factor(factor);
  for (double octaves = 0.125; agreement.factor != 1 && octaves > 0.01; octaves /= 2) {  // between the steps
    const double middle = agreement.factor;
    for (const double side : {-octaves, octaves}) try_factor(middle * std::exp2(side));
  }
  agreement.read_difference = agreement.difference;
  if (agreement.difference > kContradiction) find_misread_poses(samples, views, cameras, depths, agreement);
  find_misread_maps(views, cameras, depths, agreement);
  return agreement;
}

}  // namespace aligngs
