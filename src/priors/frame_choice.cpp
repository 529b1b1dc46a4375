#include "priors/frame_choice.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/error.h"
#include "io/resample.h"

namespace aligngs {
namespace {

constexpr int kSmallWidth = 32, kSmallHeight = 24;  // pixels: fine enough for a step of the camera, blind to noise

std::vector<float> normalised(const Image<uint8_t>& gray) {
  ImageF values(gray.width, gray.height, 1);
  std::copy(gray.data.begin(), gray.data.end(), values.data.begin());
  std::vector<float> small = resize_area(values, kSmallWidth, kSmallHeight).data;
  double sum = 0, squares = 0;
  for (const float v : small) sum += v, squares += double(v) * v;
  const double mean = sum / double(small.size()), variance = squares / double(small.size()) - mean * mean;
  const double scale = variance > 1e-6 ? 1 / std::sqrt(variance) : 0;  // a frame of one colour shows nothing
  for (float& v : small) v = float((v - mean) * scale);
  return small;
}

double mean_of(const Image<uint8_t>& gray) {
  double sum = 0;
  for (const uint8_t v : gray.data) sum += v;
  return sum / double(gray.data.size());
}

double laplacian_of(const Image<uint8_t>& gray) {
  double sum = 0;
  for (int y = 1; y + 1 < gray.height; ++y) {
    for (int x = 1; x + 1 < gray.width; ++x) {
      sum +=
          std::abs(4 * gray.at(x, y) - gray.at(x - 1, y) - gray.at(x + 1, y) - gray.at(x, y - 1) - gray.at(x, y + 1));
    }
  }
  return sum / std::max(1, (gray.width - 2) * (gray.height - 2));
}

}  // namespace

FrameFeatures FrameMeter::measure(const Image<uint8_t>& gray) {
  if (gray.channels != 1 || gray.width < 3 || gray.height < 3) {
    throw Error({ErrorKind::kFailed, "a frame to measure has one channel and at least 3 x 3 pixels", {}, "", ""});
  }
  FrameFeatures features;
  const double mean = mean_of(gray);
  features.brightness = mean / 255;
  features.sharpness = laplacian_of(gray) / std::max(mean, 1.0);
  std::vector<float> small = normalised(gray);
  if (!before_.empty()) {
    double product = 0;
    for (size_t i = 0; i < small.size(); ++i) product += double(small[i]) * before_[i];
    features.change = std::clamp(1 - product / double(small.size()), 0.0, 1.0);
  }
  before_ = std::move(small);
  return features;
}

std::vector<size_t> choose_frames(const std::vector<FrameFeatures>& frames, size_t count) {
  std::vector<size_t> chosen;
  if (count == 0) return chosen;
  if (frames.size() <= count) {
    for (size_t i = 0; i < frames.size(); ++i) chosen.push_back(i);
    return chosen;
  }
  double total = 0;
  for (const FrameFeatures& frame : frames) total += frame.change;
  // A camera that rests must not give all photos, and one that turns slowly must give some.
  constexpr double kShareOfTime = 0.25;
  const double time_weight = total > 0 ? kShareOfTime : 1, last = double(frames.size());
  double way = 0;  // 0 to 1, at the beginning of a frame
  size_t piece = 0, best = 0;
  bool open = false;
  for (size_t i = 0; i < frames.size(); ++i) {
    way += (total > 0 ? (1 - kShareOfTime) * frames[i].change / total : 0) + (i > 0 ? time_weight / last : 0);
    const auto here = std::min(count - 1, size_t(way * double(count)));
    if (open && here != piece) {
      chosen.push_back(best);
      open = false;
    }
    if (!open || frames[i].sharpness > frames[best].sharpness) best = i;
    piece = here;
    open = true;
  }
  chosen.push_back(best);
  return chosen;
}

}  // namespace aligngs
