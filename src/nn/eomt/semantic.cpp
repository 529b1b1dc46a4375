#include "nn/eomt/semantic.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "nn/cpu/row_kernels.h"
#include "nn/ops/resize.h"
#include "nn/preprocess/pillow_resize.h"

namespace aligngs::nn {
namespace {

/// Both sides times `scale`, half to even.
Image<uint8_t> scaled(const Image<uint8_t>& photo, double scale) {
  const auto side = [&](int n) { return std::max(1, int(std::lrint(n * scale))); };
  return pillow_resize_bilinear(photo, side(photo.width), side(photo.height));
}

void check_photo(const Image<uint8_t>& photo) {
  if (photo.empty() || photo.channels != 3) throw_bad_input({}, "photo", "it is not RGB");
}

void paste(const Image<uint8_t>& from, int left, int top, Image<uint8_t>& to) {
  const int width = std::min(to.width, from.width - left), height = std::min(to.height, from.height - top);
  for (int y = 0; y < height; ++y)
    std::copy_n(from.pixel(left, top + y), size_t(width) * size_t(from.channels), to.pixel(0, y));
}

/// Shares of the classes [classes, queries], without "no object".
std::vector<float> class_shares(const EomtPrediction& prediction) {
  Matrix shares = prediction.classes;
  softmax_rows(shares.data.data(), shares.rows, shares.columns);
  const int64_t queries = shares.rows, classes = shares.columns - 1;
  std::vector<float> out(size_t(classes * queries));
  for (int64_t q = 0; q < queries; ++q) {
    for (int64_t k = 0; k < classes; ++k) out[size_t(k * queries + q)] = shares.row(q)[k];
  }
  return out;
}

}  // namespace

Image<uint8_t> EomtWindows::window(size_t index) const {
  Image<uint8_t> out(side, side, resized.channels);
  paste(resized, tall ? 0 : starts.at(index), tall ? starts.at(index) : 0, out);
  return out;
}

EomtWindows eomt_windows(const Image<uint8_t>& photo, int side) {
  check_photo(photo);
  EomtWindows out;
  out.side = side;
  out.resized = scaled(photo, std::max(double(side) / photo.height, double(side) / photo.width));
  out.tall = out.resized.height > out.resized.width;
  const int length = std::max(out.resized.width, out.resized.height), count = (length + side - 1) / side;
  const int over = count * side - length;
  const double shift = over > 0 ? double(over) / (count - 1) : 0;
  for (int i = 0; i < count; ++i) out.starts.push_back(int(i * (side - shift)));  // cut, not rounded
  return out;
}

EomtPadded eomt_padded(const Image<uint8_t>& photo, int side) {
  check_photo(photo);
  const Image<uint8_t> resized = scaled(photo, std::min(double(side) / photo.height, double(side) / photo.width));
  EomtPadded out{Image<uint8_t>(side, side, 3), resized.width, resized.height};
  paste(resized, 0, 0, out.image);
  return out;
}

FeatureMap eomt_window_scores(Compute& compute, const EomtPrediction& prediction, int side) {
  const int64_t queries = prediction.masks.channels, classes = prediction.classes.columns - 1;
  const Linear shares(compute, class_shares(prediction), classes, queries, {});
  const ResampleAxis rows = bilinear_axis(prediction.masks.height, side, false);
  const ResampleAxis columns = bilinear_axis(prediction.masks.width, side, false);
  FeatureMap out(side, side, classes);
  constexpr int64_t kBand = 64;  // rows at a time: masks at the size of the window are large
  for (int64_t begin = 0; begin < side; begin += kBand) {
    const int64_t count = std::min<int64_t>(kBand, side - begin);
    FeatureMap covered = resample(compute, prediction.masks, part_of_axis(rows, begin, count), columns);
    for (float& v : covered.data) v = 1 / (1 + std::exp(-v));  // logits are resized, not shares
    const FeatureMap scores = shares(compute, covered);
    std::copy(scores.data.begin(), scores.data.end(), out.at(begin, 0));
  }
  return out;
}

FeatureMap eomt_scores(Compute& compute, const Eomt& network, const Image<uint8_t>& photo, int64_t height,
                       int64_t width) {
  const EomtWindows windows = eomt_windows(photo, network.window());
  FeatureMap sum(windows.resized.height, windows.resized.width, network.classes());
  std::vector<int> covered(size_t(std::max(sum.height, sum.width)));
  for (size_t i = 0; i < windows.starts.size(); ++i) {
    const FeatureMap scores =
        eomt_window_scores(network.exact(), network(compute, windows.window(i)), windows.side);
    const int start = windows.starts[i], left = windows.tall ? 0 : start, top = windows.tall ? start : 0;
    const int64_t rows = std::min<int64_t>(windows.side, sum.height - top);
    const int64_t line = std::min<int64_t>(windows.side, sum.width - left) * sum.channels;
    for (int64_t y = 0; y < rows; ++y) {
      const float* const from = scores.at(y, 0);
      float* const to = sum.at(top + y, left);
      for (int64_t k = 0; k < line; ++k) to[k] += from[k];
    }
    for (int k = start; k < std::min(start + windows.side, int(covered.size())); ++k) ++covered[size_t(k)];
  }
  float* const values = sum.data.data();
  for (int64_t p = 0; p < sum.places(); ++p) {
    const auto count = float(covered[size_t(windows.tall ? p / sum.width : p % sum.width)]);
    for (int64_t k = 0; k < sum.channels; ++k) values[p * sum.channels + k] /= count;
  }
  return resize_bilinear_map(compute, sum, height, width, false);
}

}  // namespace aligngs::nn
