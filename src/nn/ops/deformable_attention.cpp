#include "nn/ops/deformable_attention.h"

#include "core/error.h"
#include "nn/network_device.h"
#include "nn/ops/bilinear_sample.h"

namespace aligngs::nn {

DeformableAttention::DeformableAttention(const Compute& compute, const Weights& weights, int64_t levels, int64_t heads)
    : levels_(levels) {
  const int64_t channels = weights.dimension("sampling_offsets.weight", 1);
  const int64_t offsets = weights.dimension("sampling_offsets.weight", 0);
  const int64_t inner = weights.dimension("value_proj.weight", 0);
  constexpr int64_t kPoints = 4;  // of every published model
  heads_ = heads > 0 ? heads : offsets / (levels * kPoints * 2);
  points_ = heads_ > 0 ? offsets / (levels * heads_ * 2) : 0;
  if (points_ < 1 || points_ * levels * heads_ * 2 != offsets || inner % heads_ != 0) {
    throw Error({ErrorKind::kWeights,
                 std::to_string(offsets) + " sampling offsets do not fit " + std::to_string(levels) + " levels and " +
                     std::to_string(heads_) + " heads",
                 {},
                 "sampling_offsets.weight",
                 "set the number of heads"});
  }
  value_ = Linear(compute, weights, "value_proj", inner, channels);
  // Offsets are not rounded: a hundredth of an offset of many pixels is many edges away.
  offsets_ = Linear(compute, weights, "sampling_offsets", offsets, channels, true);
  weights_ = Linear(compute, weights, "attention_weights", offsets / 2, channels, true);
  output_ = Linear(compute, weights, "output_proj", channels, inner);
}

Matrix DeformableAttention::operator()(Compute& compute, const Matrix& query, const Matrix& reference,
                                       const Matrix& value, const std::vector<MapSize>& levels) const {
  const Matrix values = value_(compute, value);
  const int64_t width = values.columns, dim = width / heads_, samples = levels_ * points_;
  const int64_t reference_levels = reference.columns / 2;
  if (NetworkDevice* const device = compute.device()) {
    Matrix offsets = offsets_(compute, query), attention = weights_(compute, query);
    device->softmax_rows(attention.data.change_on(*device), query.rows * heads_, samples);
    DeformableSamples places{query.rows,
                             heads_,
                             dim,
                             points_,
                             reference.data.on(*device),
                             reference_levels,
                             offsets.data.on(*device),
                             attention.data.on(*device),
                             values.data.on(*device),
                             {}};
    for (const MapSize& size : levels) {
      places.sizes.push_back(size.height);
      places.sizes.push_back(size.width);
    }
    Matrix gathered(query.rows, width);
    device->deformable(places, gathered.data.write_on(*device));
    return output_(compute, gathered);
  }
  Matrix out(query.rows, output_.outputs());
  compute.for_rows(query.rows, 0, [&](int64_t begin, int64_t count, Scratch& scratch) {
    float* offsets = scratch.floats(size_t(count * offsets_.outputs()));
    float* attention = scratch.floats(size_t(count * weights_.outputs()));
    float* gathered = scratch.floats(size_t(count * width));
    offsets_.rows(query.row(begin), count, offsets, scratch);
    weights_.rows(query.row(begin), count, attention, scratch);
    softmax_rows(attention, count * heads_, samples);
    for (int64_t i = 0; i < count * heads_; ++i) {
      const int64_t head = i % heads_;
      const float* point = reference.row(begin + i / heads_);
      float* sum = gathered + i * dim;
      for (int64_t d = 0; d < dim; ++d) sum[d] = 0;
      const float* level_values = values.data.data() + head * dim;
      for (int64_t l = 0; l < levels_; ++l) {
        const MapSize& size = levels[size_t(l)];
        const float* centre = point + (l < reference_levels ? l : reference_levels - 1) * 2;
        for (int64_t p = 0; p < points_; ++p) {
          const int64_t sample = i * samples + l * points_ + p;
          const float x = centre[0] * float(size.width) + offsets[sample * 2] - 0.5f;
          const float y = centre[1] * float(size.height) + offsets[sample * 2 + 1] - 0.5f;
          add_bilinear_sample({level_values, width, dim, size.height, size.width}, x, y, attention[sample], sum);
        }
        level_values += size.places() * width;
      }
    }
    output_.rows(gathered, count, out.row(begin), scratch);
  });
  return out;
}

}  // namespace aligngs::nn
