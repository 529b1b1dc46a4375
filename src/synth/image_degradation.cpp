#include "synth/image_degradation.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "core/srgb.h"
#include "io/image_file.h"
#include "synth/textures.h"

namespace aligngs {
namespace {

ImageF blurred(const ImageF& in, double sigma) {
  if (sigma < 0.15) return in;
  const int radius = std::max(1, static_cast<int>(std::ceil(3 * sigma)));
  std::vector<float> kernel;
  float total = 0;
  for (int i = -radius; i <= radius; ++i) {
    kernel.push_back(static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma))));
    total += kernel.back();
  }
  for (float& k : kernel) k /= total;
  ImageF rows = in, out = in;
  for (const bool horizontal : {true, false}) {
    const ImageF& from = horizontal ? in : rows;
    ImageF& to = horizontal ? rows : out;
    for (int y = 0; y < in.height; ++y) {
      for (int x = 0; x < in.width; ++x) {
        for (int c = 0; c < in.channels; ++c) {
          float sum = 0;
          for (int i = -radius; i <= radius; ++i) {
            const int sx = horizontal ? std::clamp(x + i, 0, in.width - 1) : x;
            const int sy = horizontal ? y : std::clamp(y + i, 0, in.height - 1);
            sum += kernel[static_cast<size_t>(i + radius)] * from.at(sx, sy, c);
          }
          to.at(x, y, c) = sum;
        }
      }
    }
  }
  return out;
}

constexpr double kExposureSpread = 0.35;  // standard deviation of the logarithm: a third of a stop below a half
constexpr double kBalanceSpread = 0.10;   // the same of red and blue against green
constexpr double kExposureDrift = 0.85;   // correlation between neighbouring photos

}  // namespace

std::array<double, 3> exposure_walk(Random random, size_t index) {
  const double fresh = std::sqrt(1 - kExposureDrift * kExposureDrift), most = std::log(2.0);
  double gain = random.normal(), red = random.normal(), blue = random.normal();
  for (size_t i = 0; i < index; ++i) {
    for (double* state : {&gain, &red, &blue}) *state = kExposureDrift * *state + fresh * random.normal();
  }
  const auto limited = [&](double x) { return std::clamp(x, -most, most); };
  const double common = kExposureSpread * gain;
  return {limited(common + kBalanceSpread * red), limited(common), limited(common + kBalanceSpread * blue)};
}

namespace {

/// The first numbers that a photo draws.
std::array<double, 3> draw_gains(const ImageDegradationSettings& s, Random& random) {
  const double gain = 1 + random.uniform(-s.gain, s.gain);
  const double red = gain * (1 + random.uniform(-s.white_balance, s.white_balance));
  const double blue = gain * (1 + random.uniform(-s.white_balance, s.white_balance));
  return {red * std::exp(s.log_gain[0]), gain * std::exp(s.log_gain[1]), blue * std::exp(s.log_gain[2])};
}

}  // namespace

std::array<double, 3> photo_gains(const ImageDegradationSettings& settings, Random random) {
  return draw_gains(settings, random);
}

Image<uint8_t> degrade_image(const ImageF& color, const ImageDegradationSettings& s, Random random) {
  const std::array<double, 3> gains = draw_gains(s, random);
  const double sigma = random.uniform(0, s.blur) / 2.355;  // full width at half maximum to standard deviation
  const float factors[3] = {static_cast<float>(gains[0]), static_cast<float>(gains[1]), static_cast<float>(gains[2])};
  ImageF out = color;
  for (size_t i = 0; i < out.data.size(); ++i) out.data[i] = srgb_encode(srgb_decode(out.data[i]) * factors[i % 3]);
  out = blurred(out, sigma);
  for (float& value : out.data) {
    value += static_cast<float>(s.noise * std::sqrt(0.3 + 1.4 * std::max(0.0f, value)) * random.normal());
  }
  const Image<uint8_t> bytes = to_bytes(out);
  if (s.jpeg_quality <= 0) return bytes;
  const std::vector<uint8_t> coded = encode_jpeg(bytes, s.jpeg_quality);
  return decode_image(std::string_view(reinterpret_cast<const char*>(coded.data()), coded.size()), "simulated photo");
}

}  // namespace aligngs
