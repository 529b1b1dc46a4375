#include "train/photo_opinions.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/cpu/view_votes.h"
#include "gaussians/gaussian_geometry.h"

namespace aligngs {
namespace {

constexpr float kLeastVotes = 0.01f;  // pixels
// of a trait, each with as many opinions: thousands, so that rates are exact within a percent
constexpr size_t kRanges = 8;
constexpr double kLeastWeight = 0.1;  // log-odds; 0 would be a coin
constexpr double kPriorVotes = 100;   // pixels at the mean rate that every range begins with
constexpr double kMostSure = 0.995;   // rate: what agrees always may still be wrong together

double log_odds(double rate) {
  const double r = std::clamp(rate, 1 - kMostSure, kMostSure);
  return std::log(r / (1 - r));
}

PhotoOpinion opinion_of(const GaussianModel& model, size_t i, const float* votes, size_t channels, const Camera& camera,
                        const Vec3d& centre) {
  PhotoOpinion o;
  o.gaussian = static_cast<uint32_t>(i);
  double sum = 0;
  for (size_t c = 0; c < channels; ++c) {
    sum += static_cast<double>(votes[c]);
    size_t at = PhotoOpinion::kNames;
    while (at > 0 && votes[c] > o.share[at - 1]) --at;
    if (at == PhotoOpinion::kNames) continue;
    for (size_t k = PhotoOpinion::kNames - 1; k > at; --k) o.share[k] = o.share[k - 1], o.channel[k] = o.channel[k - 1];
    o.share[at] = votes[c];
    o.channel[at] = static_cast<uint16_t>(c);
  }
  o.votes = static_cast<float>(sum);
  if (!(o.votes > 0)) return o;
  for (float& share : o.share) share /= o.votes;
  const Vec3d position = position_of(model, i);
  const Vec3d seen = camera.world_to_camera * position, to_camera = centre - position;
  const Vec2d pixel = camera.project(seen);
  o.trait[PhotoOpinion::kConfidence] = o.share[0];
  o.trait[PhotoOpinion::kDistance] = static_cast<float>(norm(to_camera));
  o.trait[PhotoOpinion::kAngle] = static_cast<float>(std::abs(dot(normalized(to_camera), shortest_axis(model, i))));
  o.trait[PhotoOpinion::kBorder] = static_cast<float>(
      std::max(0.0, std::min(std::min(pixel.x, camera.width - pixel.x), std::min(pixel.y, camera.height - pixel.y))));
  return o;
}

/// Upper ends of the ranges of a trait but the last.
std::array<float, kRanges - 1> range_ends(const PhotoOpinions& opinions, size_t trait) {
  std::vector<float> values;
  for (const auto& photo : opinions.of_photo) {
    for (const PhotoOpinion& o : photo) values.push_back(o.trait[trait]);
  }
  std::array<float, kRanges - 1> ends{};
  if (values.empty()) return ends;
  std::sort(values.begin(), values.end());
  for (size_t k = 0; k + 1 < kRanges; ++k) ends[k] = values[(k + 1) * values.size() / kRanges];
  return ends;
}

size_t range_of(const std::array<float, kRanges - 1>& ends, float value) {
  return static_cast<size_t>(std::upper_bound(ends.begin(), ends.end(), value) - ends.begin());
}

/// Whether the other photos call the Gaussian as this opinion does; false: it is the only one.
bool others_agree(const PhotoOpinion& o, const float* all, size_t channels, bool& others) {
  float most = 0;
  size_t best = channels;
  for (size_t c = 0; c < channels; ++c) {
    float votes = all[c];
    for (size_t k = 0; k < PhotoOpinion::kNames; ++k) {
      if (o.share[k] > 0 && o.channel[k] == c) votes -= o.share[k] * o.votes;
    }
    if (votes > most) most = votes, best = c;
  }
  others = most > kLeastVotes;
  return best == o.channel[0];
}

}  // namespace

PhotoOpinions gather_opinions(const GaussianModel& model, const std::vector<TrainingView>& views,
                              const std::vector<float>& near_planes, const RasterSettings& raster, ThreadPool& pool) {
  PhotoOpinions opinions;
  opinions.of_photo.resize(views.size());
  if (views.empty()) return opinions;
  opinions.channels = views[0].data.semantics.channels;
  const size_t channels = static_cast<size_t>(opinions.channels);
  cpu::ViewVotes votes(model, opinions.channels, pool);
  for (size_t v = 0; v < views.size(); ++v) {
    RasterSettings own = raster;
    own.near_plane = near_planes[v];
    const std::vector<float>& sums = votes.of(views[v], own);
    const Camera& camera = views[v].data.camera;
    const Vec3d centre = camera.centre();
    for (size_t i = 0; i < model.size(); ++i) {
      const PhotoOpinion o = opinion_of(model, i, &sums[i * channels], channels, camera, centre);
      if (o.votes >= kLeastVotes) opinions.of_photo[v].push_back(o);
    }
  }
  return opinions;
}

std::vector<float> sum_votes(const PhotoOpinions& opinions, size_t gaussians) {
  const size_t channels = static_cast<size_t>(opinions.channels);
  std::vector<float> sums(gaussians * channels, 0.0f);
  for (const auto& photo : opinions.of_photo) {
    for (const PhotoOpinion& o : photo) {
      for (size_t k = 0; k < PhotoOpinion::kNames; ++k)
        sums[o.gaussian * channels + o.channel[k]] += o.weight * o.votes * o.share[k];
    }
  }
  return sums;
}

void calibrate_opinions(size_t gaussians, PhotoOpinions& opinions) {
  const size_t channels = static_cast<size_t>(opinions.channels);
  const std::vector<float> all = sum_votes(opinions, gaussians);
  std::array<std::array<float, kRanges - 1>, PhotoOpinion::kTraits> ends;
  for (size_t t = 0; t < PhotoOpinion::kTraits; ++t) ends[t] = range_ends(opinions, t);
  double right = 0, heard = 0;
  std::array<std::array<double, kRanges>, PhotoOpinion::kTraits> range_right{}, range_heard{};
  for (const auto& photo : opinions.of_photo) {
    for (const PhotoOpinion& o : photo) {
      bool others = false;
      const bool agrees = others_agree(o, &all[o.gaussian * channels], channels, others);
      if (!others) continue;
      const double votes = static_cast<double>(o.votes);
      heard += votes;
      right += agrees ? votes : 0;
      for (size_t t = 0; t < PhotoOpinion::kTraits; ++t) {
        const size_t r = range_of(ends[t], o.trait[t]);
        range_heard[t][r] += votes;
        range_right[t][r] += agrees ? votes : 0;
      }
    }
  }
  if (!(heard > 0)) return;
  const double mean = log_odds(right / heard);
  std::array<std::array<double, kRanges>, PhotoOpinion::kTraits> more{};
  for (size_t t = 0; t < PhotoOpinion::kTraits; ++t) {
    for (size_t r = 0; r < kRanges; ++r) {
      more[t][r] =
          log_odds((range_right[t][r] + kPriorVotes * right / heard) / (range_heard[t][r] + kPriorVotes)) - mean;
    }
  }
  for (auto& photo : opinions.of_photo) {
    for (PhotoOpinion& o : photo) {
      double odds = mean;
      for (size_t t = 0; t < PhotoOpinion::kTraits; ++t) odds += more[t][range_of(ends[t], o.trait[t])];
      o.weight = static_cast<float>(std::max(odds, kLeastWeight));
    }
  }
}

}  // namespace aligngs
