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

/// Scores [rows, columns, classes] of a window at outputs of the axes that bring its masks to its size.
FeatureMap scores_at(Compute& compute, const Linear& shares, const EomtPrediction& prediction, const ResampleAxis& rows,
                     const ResampleAxis& columns) {
  FeatureMap out(rows.outputs(), columns.outputs(), shares.outputs());
  constexpr int64_t kBand = 64;  // rows at a time: masks at the size of the window are large
  for (int64_t begin = 0; begin < out.height; begin += kBand) {
    const int64_t count = std::min(kBand, out.height - begin);
    FeatureMap covered = resample(compute, prediction.masks, part_of_axis(rows, begin, count), columns);
    float* const masks = covered.data.data();
    const int64_t line = covered.width * covered.channels;
    compute.for_rows(count, 1, [&](int64_t y, int64_t, Scratch&) {  // logits are resized, not shares
      for (int64_t i = y * line; i < (y + 1) * line; ++i) masks[i] = 1 / (1 + std::exp(-masks[i]));
    });
    const FeatureMap scores = shares(compute, covered);
    std::copy(scores.data.begin(), scores.data.end(), out.at(begin, 0));
  }
  return out;
}

Linear shares_of(Compute& compute, const EomtPrediction& prediction) {
  return Linear(compute, class_shares(prediction), prediction.classes.columns - 1, prediction.masks.channels, {});
}

/// Those of the `places` (sorted, along one side of the resized photo) that lie in [begin, begin + side).
struct Covered {
  size_t first = 0;              ///< of them in `places`
  std::vector<int64_t> outputs;  ///< their places in the window
};

Covered covered_by(const std::vector<int64_t>& places, int64_t begin, int64_t side) {
  Covered covered;
  covered.first = size_t(std::lower_bound(places.begin(), places.end(), begin) - places.begin());
  for (size_t i = covered.first; i < places.size() && places[i] < begin + side; ++i)
    covered.outputs.push_back(places[i] - begin);
  return covered;
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
  return scores_at(compute, shares_of(compute, prediction), prediction,
                   bilinear_axis(prediction.masks.height, side, false),
                   bilinear_axis(prediction.masks.width, side, false));
}

FeatureMap eomt_scores(Compute& compute, const Eomt& network, const Image<uint8_t>& photo, int64_t height,
                       int64_t width) {
  const EomtWindows windows = eomt_windows(photo, network.window());
  // The last resizing weighs few places of the resized photo where the result is small, so only these are computed.
  const UsedInputs rows = used_inputs(bilinear_axis(windows.resized.height, height, false));
  const UsedInputs columns = used_inputs(bilinear_axis(windows.resized.width, width, false));
  FeatureMap sum(int64_t(rows.inputs.size()), int64_t(columns.inputs.size()), network.classes());
  std::vector<float> windows_over(windows.tall ? rows.inputs.size() : columns.inputs.size());
  float* const sums = sum.data.data();
  for (size_t i = 0; i < windows.starts.size(); ++i) {
    const int start = windows.starts[i];
    const Covered down = covered_by(rows.inputs, windows.tall ? start : 0, windows.side);
    const Covered across = covered_by(columns.inputs, windows.tall ? 0 : start, windows.side);
    const EomtPrediction prediction = network(compute, windows.window(i));
    const FeatureMap scores =
        scores_at(network.exact(), shares_of(network.exact(), prediction), prediction,
                  part_of_axis(bilinear_axis(prediction.masks.height, windows.side, false), down.outputs),
                  part_of_axis(bilinear_axis(prediction.masks.width, windows.side, false), across.outputs));
    const float* const found = scores.data.data();
    const int64_t line = scores.width * scores.channels;
    compute.for_rows(scores.height, 1, [&](int64_t y, int64_t, Scratch&) {
      float* const to = sums + ((int64_t(down.first) + y) * sum.width + int64_t(across.first)) * sum.channels;
      for (int64_t k = 0; k < line; ++k) to[k] += found[y * line + k];
    });
    const Covered& along = windows.tall ? down : across;
    for (size_t k = 0; k < along.outputs.size(); ++k) ++windows_over[along.first + k];
  }
  compute.for_rows(sum.height, 1, [&](int64_t y, int64_t, Scratch&) {
    for (int64_t x = 0; x < sum.width; ++x) {
      const float count = windows_over[size_t(windows.tall ? y : x)];
      for (int64_t k = 0; k < sum.channels; ++k) sums[(y * sum.width + x) * sum.channels + k] /= count;
    }
  });
  return resample(compute, sum, rows.axis, columns.axis);
}

}  // namespace aligngs::nn
