#include "nn/matrix_rate.h"

#include <algorithm>

#include "core/random.h"
#include "core/steady_seconds.h"
#include "nn/ops/linear.h"

namespace aligngs::nn {

double measure_matrix_rate(Compute& compute) {
  constexpr int64_t kWidth = 1024, kRows = 2048;  // of a ViT-L on a photo
  constexpr double kSeconds = 0.25;
  Random random(1);
  std::vector<float> weight(size_t(kWidth * kWidth));
  for (float& v : weight) v = float(random.normal());
  const Linear linear(compute, weight, kWidth, kWidth, {});
  Matrix x(kRows, kWidth);
  for (int64_t i = 0; i < kRows * kWidth; ++i) x.data[size_t(i)] = float(random.normal());
  double best = 1e9;
  for (const double start = steady_seconds(); steady_seconds() - start < kSeconds;) {
    const double begin = steady_seconds();
    linear(compute, x);
    best = std::min(best, steady_seconds() - begin);
  }
  return 2.0 * double(kRows * kWidth * kWidth) / std::max(best, 1e-9);
}

}  // namespace aligngs::nn
