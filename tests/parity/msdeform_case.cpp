#include "nn/ops/deformable_attention.h"
#include "parity_case.h"

namespace aligngs::parity {
namespace {

/// Item `n` of [batch, rows, ...], with what follows as columns.
nn::Matrix matrix_of(const FloatArray& array, int64_t n) {
  const int64_t size = int64_t(array.data.size()) / array.shape.at(0);
  const float* const from = array.data.data() + n * size;
  nn::Matrix m(array.shape.at(1), size / array.shape.at(1));
  m.data = std::vector<float>(from, from + size);
  return m;
}

}  // namespace

void run_deformable_attention(Case& test, nn::Compute& compute) {
  const Json& config = test.config();
  std::vector<nn::MapSize> levels;
  for (const Json& size : config.at("shapes")) levels.push_back({size.at(0), size.at(1)});
  const nn::DeformableAttention attention(compute, test.weights("weights.safetensors"), int64_t(levels.size()),
                                          config.at("heads").get<int64_t>());
  const FloatArray query = test.array("in_query"), reference = test.array("in_ref"), value = test.array("in_value");
  for (int64_t n = 0; n < query.shape.at(0); ++n) {
    const nn::Matrix out =
        attention(compute, matrix_of(query, n), matrix_of(reference, n), matrix_of(value, n), levels);
    test.collect("out", out.data, {out.rows, out.columns});
  }
  test.compare_collected();
}

}  // namespace aligngs::parity
