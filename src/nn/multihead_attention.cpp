#include "nn/multihead_attention.h"

#include "core/error.h"
#include "nn/attention.h"
#include "nn/network_device.h"

namespace aligngs::nn {

MultiheadAttention::MultiheadAttention(const Compute& compute, const Weights& weights, int64_t channels, int64_t heads)
    : heads_(heads), out_(compute, weights, "out_proj", channels, channels) {
  if (heads <= 0 || channels % heads != 0) {
    throw Error({ErrorKind::kWeights,
                 std::to_string(channels) + " channels do not divide into " + std::to_string(heads) + " heads",
                 {},
                 "in_proj_weight",
                 "set the number of heads"});
  }
  const std::vector<float> weight = weights.load("in_proj_weight", {3 * channels, channels});
  const std::vector<float> bias = weights.load("in_proj_bias", {3 * channels});
  Linear* parts[] = {&query_, &key_, &value_};
  for (int64_t i = 0; i < 3; ++i) {
    const auto rows = weight.begin() + i * channels * channels;
    const auto entries = bias.begin() + i * channels;
    *parts[i] = Linear(compute, {rows, rows + channels * channels}, channels, channels, {entries, entries + channels});
  }
}

Matrix MultiheadAttention::operator()(Compute& compute, const Matrix& query, const Matrix& key, const Matrix& value,
                                      int64_t masks, const uint8_t* masked) const {
  const int64_t channels = query.columns, dim = channels / heads_;
  if (NetworkDevice* const device = compute.device()) {
    const Matrix q = query_(compute, query), k = key_(compute, key), v = value_(compute, value);
    Matrix seen(query.rows, channels);
    const auto rows = [&](const Matrix& m) { return AttentionRows{m.data.on(*device), channels}; };
    device->attention({1, heads_, dim, query.rows, key.rows, masks}, rows(q), rows(k), rows(v), masked,
                      compute.precision(), seen.data.write_on(*device));
    return out_(compute, seen);
  }
  AttentionOperands operands(compute, {1, heads_, dim, query.rows, key.rows, masks});
  const auto project = [&](const Linear& linear, const Matrix& x,
                           void (AttentionOperands::*set)(int64_t, int64_t, const float*)) {
    compute.for_rows(x.rows, 0, [&](int64_t begin, int64_t count, Scratch& scratch) {
      float* rows = scratch.floats(size_t(count * channels));
      linear.rows(x.row(begin), count, rows, scratch);
      for (int64_t i = 0; i < count; ++i) (operands.*set)(0, begin + i, rows + i * channels);
    });
  };
  project(query_, query, &AttentionOperands::set_query_row);
  project(key_, key, &AttentionOperands::set_key_row);
  project(value_, value, &AttentionOperands::set_value_row);
  Matrix attended(query.rows, channels);
  attention(compute, operands, attended.data.data(), masked);
  return out_(compute, attended);
}

}  // namespace aligngs::nn
