#include "nn/matrix_rate.h"

#include <algorithm>
#include <chrono>

#include "core/random.h"
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
  using Clock = std::chrono::steady_clock;
  const auto seconds_since = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  double best = 1e9;
  for (const auto start = Clock::now(); seconds_since(start) < kSeconds;) {
    const auto begin = Clock::now();
    linear(compute, x);
    best = std::min(best, seconds_since(begin));
  }
  return 2.0 * double(kRows * kWidth * kWidth) / std::max(best, 1e-9);
}

}  // namespace aligngs::nn
