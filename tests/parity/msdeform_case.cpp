#include "nn/ops/deformable_attention.h"
#include "parity_case.h"

namespace aligngs::parity {
namespace {

/// [1, rows, ...] with what follows as columns.
nn::Matrix matrix_of(const FloatArray& array) {
  nn::Matrix m(array.shape.at(1), 1);
  m.columns = int64_t(array.data.size()) / m.rows;
  m.data = array.data;
  return m;
}

}  // namespace

void run_deformable_attention(Case& test, nn::Compute& compute) {
  const Json& config = test.config();
  std::vector<nn::MapSize> levels;
  for (const Json& size : config.at("shapes")) levels.push_back({size.at(0), size.at(1)});
  const nn::DeformableAttention attention(compute, test.weights("weights.safetensors"),
                                          int64_t(levels.size()),
                                          config.at("heads").get<int64_t>());
  const nn::Matrix query = matrix_of(test.array("in_query"));
  const nn::Matrix out = attention(compute, query, matrix_of(test.array("in_ref")),
                                   matrix_of(test.array("in_value")), levels);
  test.compare("out", out.data, {1, out.rows, out.columns});
}

}  // namespace aligngs::parity
